# lightcuts.bash - completion of commands, options, their values and files.

# The names of instruction sets, as the program has them in its help.
_lightcuts_isas()
{
    "${COMP_WORDS[0]/#\~/$HOME}" render --help 2>/dev/null |
        sed -n 's/,//g; s/ or / /; s/.*--isa I *use at most \([a-z0-9 ]*\).*/\1/p'
}

_lightcuts()
{
    local word=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]} command=render options i
    local commands='render compare scene info preview explain merge bench report converge lux relight help'
    COMPREPLY=()
    case ${COMP_WORDS[1]-} in
    render | compare | scene | info | preview | explain | merge | bench | report | converge | lux | relight | \
        help)
        command=${COMP_WORDS[1]} ;;
    esac
    # "--name=value" comes in three words.
    if [[ $word == = ]]; then
        word=
    elif [[ $previous == = ]]; then
        previous=${COMP_WORDS[COMP_CWORD-2]}
    fi

    case $command:$previous in
    help:help) COMPREPLY=($(compgen -W "${commands% help}" -- "$word")); return ;;
    scene:scene | bench:--quality)
        COMPREPLY=($(compgen -W 'cornell stairs room grid cube bulbs student1 student2 student3 student3top
            student4 student5' -- "$word"))
        return ;;
    bench:bench) COMPREPLY=($(compgen -W 'bounds rays tree render layout' -- "$word")); return ;;
    render:--method | lux:--method | explain:--method | bench:--method)
        COMPREPLY=($(compgen -W 'lightcuts exact cuts' -- "$word"))
        return ;;
    render:--builder | explain:--builder | bench:--builder)
        COMPREPLY=($(compgen -W 'auto exact ploc' -- "$word"))
        return ;;
    lux:--indirect-lights) COMPREPLY=($(compgen -W auto -- "$word")); return ;;
    render:--bvh | explain:--bvh | bench:--bvh) COMPREPLY=($(compgen -W 'best fast' -- "$word")); return ;;
    render:--display-server) COMPREPLY=($(compgen -W localhost:14158 -- "$word")); return ;;
    render:--chunk) COMPREPLY=($(compgen -W slurm -- "$word")); return ;;
    render:--isa | lux:--isa | explain:--isa | bench:--isa | report:--isa)
        COMPREPLY=($(compgen -W "$(_lightcuts_isas)" -- "$word"))
        return ;;
    render:--aov)
        # A list with commas: complete its last part.
        local head=
        [[ $word == *,* ]] && head=${word%,*},
        COMPREPLY=($(compgen -P "$head" -W 'cut n p z albedo error rays interval alpha all' -- "${word##*,}"))
        return ;;
    render:-t | render:--nthreads | explain:-t | explain:--nthreads | bench:-t | bench:--nthreads | \
        report:-t | report:--nthreads | converge:-t | converge:--nthreads | \
        lux:-t | lux:--nthreads)
        COMPREPLY=($(compgen -W "1 2 4 $(nproc 2>/dev/null)" -- "$word"))
        return ;;
    render:--error | render:--within | render:--time | render:--error-ratio | render:--max-cut | \
        render:--dark-floor | render:--representatives | \
        render:--maxdepth | render:--area-lights | render:--env-lights | render:--indirect-lights | \
        render:--indirect-error | \
        render:--seed | render:--spp | render:--pixelbounds | render:--cropwindow | \
        render:--resolution | render:--exposure | render:--frames | render:--frame | \
        render:--group | explain:--group | info:--group | relight:--exposure | \
        render:--print-chunks | render:--time-limit | render:--max-memory | render:--checkpoint-interval | \
        render:--preview-interval | \
        compare:--average | compare:--over | compare:--scale | preview:--exposure | preview:--range | \
        scene:--lights | scene:--seed | converge:--pixels | converge:--spp | converge:--seed | \
        lux:--grid | lux:--efficacy | lux:--error | lux:--within | lux:--dark-floor | lux:--area-lights | \
        lux:--env-lights | lux:--indirect-error | lux:--maxdepth | lux:--seed | lux:--max-memory | \
        bench:--runs | bench:--lights | bench:--error-ratio | bench:--max-cut | bench:--dark-floor | \
        explain:--pixel | explain:--sample | explain:--top | \
        explain:--error | explain:--within | explain:--error-ratio | explain:--max-cut | explain:--dark-floor | \
        explain:--representatives | explain:--area-lights | explain:--env-lights | explain:--indirect-lights | \
        explain:--indirect-error | \
        explain:--maxdepth | explain:--seed | explain:--spp | \
        bench:--representatives | bench:--pixelbounds | \
        report:--error-ratios | report:--representatives | report:--max-cut) return ;;
    render:--indirect-from | explain:--indirect-from)
        COMPREPLY=($(compgen -W "scene view" -- "$word"))
        return ;;
    report:-o | report:--outdir | render:--sandbox)
        compopt -o filenames 2>/dev/null
        COMPREPLY=($(compgen -d -- "$word"))
        return ;;
    compare:--map) COMPREPLY=($(compgen -W heat -- "$word")); return ;;
    compare:--fail)
        compopt -o nospace 2>/dev/null
        COMPREPLY=($(compgen -S = -W 'mae mse rmse mrse mape psnr flip roberts max mean_ratio
            rel_p50 rel_p95 rel_p99 rel_p999 rel_max over nonfinite' -- "$word"))
        return ;;
    preview:--false-colour)
        COMPREPLY=($(compgen -W 'R G B cut.size cut.rays cut.error N.X N.Y N.Z P.X P.Y P.Z Z
            Albedo.R Albedo.G Albedo.B' -- "$word"))
        return ;;
    esac

    if [[ $word == -* ]]; then
        case $command in
        render) options='--outfile --method --error --within --time --calibration
            --error-ratio --max-cut --dark-floor --representatives
            --builder --maxdepth --area-lights --env-lights --indirect-lights --indirect-error
            --indirect-from --seed --spp --group --resolution --exposure --tone --pixelbounds --cropwindow
            --frames --track --frame --seed-per-frame --chunk --print-chunks --checkpoint
            --resume --time-limit --sandbox --max-memory --checkpoint-interval --keep-checkpoint --write-partial --watch
            --every-pixel --preview --preview-interval
            --display-server --aov
            --nthreads --bvh --isa --stats --stats-file --write-time --quiet --verbose
            --help' ;;
        compare) options='--average --over --fail --outfile --scale --map --json --help' ;;
        scene) options='--lights --seed --outfile --help' ;;
        info) options='--json --group --help' ;;
        converge) options='--outfile --pixels --spp --seed --nthreads --json --help' ;;
        lux) options='--grid --points --camera --cylindrical --scalar --outfile --json --efficacy --error
            --within --dark-floor --method --indirect-lights --indirect-error --maxdepth --area-lights
            --env-lights --seed --max-memory --nthreads --isa --quiet --help' ;;
        preview) options='--outfile --exposure --tone --false-colour --range --help' ;;
        relight) options='--outfile --exposure --tone --help' ;;
        explain) options='--pixel --sample --top --all --json --group --method --error --within
            --error-ratio --max-cut --dark-floor --representatives --builder --area-lights
            --env-lights --indirect-lights --indirect-error --indirect-from --maxdepth --seed
            --spp --nthreads --bvh --isa --help' ;;
        merge) options='--outfile --help' ;;
        bench) options='--mesh --rays --lights --quality --scaling --outfile --method --error-ratio
            --max-cut --dark-floor --representatives --builder --pixelbounds --nthreads --bvh --isa --runs
            --json --help' ;;
        report) options='--outdir --quick --error-ratios --representatives --max-cut --nthreads --isa
            --quiet --help' ;;
        *) options= ;;
        esac
        ((COMP_CWORD == 1)) && options="$options --version"
        COMPREPLY=($(compgen -W "$options" -- "$word"))
        return
    fi

    local extensions='pbrt|gltf|glb|obj'
    case $command in
    compare | preview) extensions='exr|png' ;;
    merge | relight) extensions='exr' ;;
    info) extensions='pbrt|gltf|glb|obj|exr|png' ;;
    scene | help) return ;;
    esac
    case $previous in
    -o | --outfile)
        case $command in bench) extensions=svg ;; lux) extensions='csv|png' ;; *) extensions='exr|png' ;; esac ;;
    --points) extensions='csv' ;;
    --stats-file) extensions='json' ;;
    --checkpoint) extensions='ckpt' ;;
    --mesh) extensions='mesh\.bin' ;;
    --rays) extensions='rays\.bin' ;;
    esac
    local IFS=$'\n'
    compopt -o filenames 2>/dev/null
    for i in $(compgen -f -- "$word"); do
        if [[ -d $i || $i =~ \.($extensions)$ ]]; then COMPREPLY+=("$i"); fi
    done
    ((COMP_CWORD == 1)) && COMPREPLY+=($(IFS=' '; compgen -W "$commands" -- "$word"))
}
complete -F _lightcuts lightcuts
