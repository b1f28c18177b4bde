# Pieces of a take, each begun without a start, and the whole.


rule track:
    input:
        take=lambda wildcards: take_folder(wildcards.take),
        body=body_of,
    output:
        directory("results/{take}/pieces/{first}-{past}"),
    log:
        "results/{take}/logs/track-{first}-{past}.log",
    threads: 2
    resources:
        mem_mb=4000,
        runtime=240,
    params:
        model=model_option,
        options=lambda wildcards: f"{config['track']} {row_of(wildcards).get('track', '')}",
    shell:
        "{STEP} {log} --folder {output} {BACKLIT} track {input.take} --start search {params.model} {params.options}"
        " --frames {wildcards.first}..{wildcards.past} >> {log}"


rule join:
    input:
        pieces,
    output:
        directory("results/{take}/track"),
    log:
        "results/{take}/logs/join.log",
    resources:
        mem_mb=4000,
        runtime=30,
    shell:
        "{STEP} {log} --folder {output} {BACKLIT} join {input} >> {log}"
