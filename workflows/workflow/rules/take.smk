# From footage to a take, its cameras checked, and the person's own body.


rule import_take:
    input:
        lambda wildcards: existing(row_of(wildcards)["source"]),
    output:
        directory("results/{take}/take"),
    log:
        "results/{take}/logs/import.log",
    threads: 2
    resources:
        mem_mb=4000,
        runtime=60,
    params:
        source=lambda wildcards: shlex.quote(row_of(wildcards)["source"]),
        options=lambda wildcards: row_of(wildcards).get("import", ""),
    shell:
        "{STEP} {log} --folder {output} {BACKLIT} import {params.source} {params.options} >> {log}"


checkpoint check:
    input:
        lambda wildcards: take_folder(wildcards.take),
    output:
        "results/{take}/cameras.json",
    log:
        "results/{take}/logs/check.log",
    threads: 2
    resources:
        mem_mb=4000,
        runtime=60,
    shell:
        "{STEP} {log} {BACKLIT} check {input} --json > {output}.part && mv {output}.part {output}"


# Once for each person, in the first of their takes.
rule body:
    input:
        take=lambda wildcards: take_folder(PEOPLE[wildcards.person][0]),
        check=lambda wildcards: f"results/{PEOPLE[wildcards.person][0]}/cameras.json",
    output:
        "results/people/{person}.toml",
    log:
        "results/people/{person}.log",
    threads: 2
    resources:
        mem_mb=4000,
        runtime=60,
    params:
        past=lambda wildcards, input: min(frames_of(input.check), config["body_frames"]),
        options=config["fit_body"],
    shell:
        "{STEP} {log} {BACKLIT} fit-body {input.take} --frames 0..{params.past} {params.options}"
        " --out {output} >> {log}"
