# What a take's track is worth, and what is sent on.


rule compare:
    input:
        reference,
        track="results/{take}/track",
    output:
        directory("results/{take}/compared"),
    log:
        "results/{take}/logs/compare.log",
    resources:
        mem_mb=4000,
        runtime=30,
    params:
        reference=reference_path,
        options=lambda wildcards: row_of(wildcards).get("compare", ""),
    shell:
        "{STEP} {log} --folder {output} {BACKLIT} compare {input.track} {params.reference} {params.options} >> {log}"


rule export:
    input:
        "results/{take}/track",
    output:
        directory("results/{take}/motion"),
    log:
        "results/{take}/logs/export.log",
    resources:
        mem_mb=2000,
        runtime=30,
    params:
        formats=",".join(config["export"]),
    shell:
        "{STEP} {log} --folder {output} {BACKLIT} export {input} --to {params.formats} >> {log}"


rule page:
    input:
        reference,
        track="results/{take}/track",
        take=lambda wildcards: take_folder(wildcards.take),
    output:
        report("results/{take}/page.html", caption="../report/page.rst", category="Takes", labels={"take": "{take}"}),
    log:
        "results/{take}/logs/page.log",
    resources:
        mem_mb=4000,
        runtime=30,
    params:
        compare=lambda wildcards: f"--compare {reference_path(wildcards)}" if reference(wildcards) else "",
        pictures=config["page_pictures"],
    shell:
        "{STEP} {log} {BACKLIT} report {input.track} --take {input.take} {params.compare}"
        " --pictures {params.pictures} --out {output} >> {log}"


rule index:
    input:
        all_results,
    output:
        report("results/index.html", caption="../report/index.rst", category="Index"),
    log:
        "results/index.log",
    localrule: True
    params:
        command=index_command("index"),
    shell:
        "{params.command} 2> {log} && rm -f results/unfinished.html"
