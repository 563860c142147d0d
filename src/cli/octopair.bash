# Completion of octopair's command line for bash.

# The kinds of scenes, asked of the program.
_octopair_kinds() {
    "$1" generate --help 2>/dev/null | sed -n '/^Kinds:/,$ s/^  \([a-z0-9-]*\) .*/\1/p'
}

# The engines that it was built with.
_octopair_engines() {
    "$1" info 2>/dev/null | sed -n 's/^engines *//p' | tr -d ,
}

_octopair() {
    local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}
    local subcommand=${COMP_WORDS[1]}
    COMPREPLY=()

    if ((COMP_CWORD == 1)); then
        mapfile -t COMPREPLY < <(compgen -W "bench detect generate info replay --help --version" -- "$current")
        return
    fi
    case $previous in
        --scene) mapfile -t COMPREPLY < <(compgen -W "$(_octopair_kinds "$1")" -- "$current"); return ;;
        --stage) mapfile -t COMPREPLY < <(compgen -W "pairs" -- "$current"); return ;;
        --objects)
            if [[ $subcommand == detect ]]; then
                mapfile -t COMPREPLY < <(compgen -W "node triangle" -- "$current")
            fi
            return ;;
        --order) mapfile -t COMPREPLY < <(compgen -W "ascending octal" -- "$current"); return ;;
        --engine) mapfile -t COMPREPLY < <(compgen -W "$(_octopair_engines "$1")" -- "$current"); return ;;
        --margin | --limit | --threads | --workers | --seed | --frames | --rounds) return ;;
        --against | --json | --padding | --output | --stats) mapfile -t COMPREPLY < <(compgen -f -- "$current"); return ;;
    esac
    case $subcommand in
        bench)
            if ((COMP_CWORD == 2)); then
                mapfile -t COMPREPLY < <(compgen -W "paper" -- "$current")
            else
                mapfile -t COMPREPLY < <(compgen -W "--scene --objects --threads --rounds --json --quiet --help" -- "$current")
            fi ;;
        detect)
            if [[ $current == -* ]]; then
                mapfile -t COMPREPLY < <(compgen -W "--against --stage --objects --margin --padding --output --order
                    --count-only --events --limit --fail-on-collision --engine --threads --workers --stats --quiet --help" -- "$current")
            else
                mapfile -t COMPREPLY < <(compgen -f -- "$current")
            fi ;;
        generate)
            if ((COMP_CWORD == 2)); then
                mapfile -t COMPREPLY < <(compgen -W "$(_octopair_kinds "$1")" -- "$current")
            else
                mapfile -t COMPREPLY < <(compgen -W "--objects --seed --frames --output --quiet --help" -- "$current")
            fi ;;
        replay)
            if [[ $current == -* ]]; then
                mapfile -t COMPREPLY < <(compgen -W "--threads --check --quiet --help" -- "$current")
            else
                mapfile -t COMPREPLY < <(compgen -f -- "$current")
            fi ;;
        info) mapfile -t COMPREPLY < <(compgen -W "--help" -- "$current") ;;
    esac
}

complete -o filenames -F _octopair octopair
