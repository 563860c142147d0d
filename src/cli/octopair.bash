# Bash completion for octopair.

# Prints the kinds of scenes that the program can generate.
_octopair_kinds() {
    "$1" generate --help 2>/dev/null | sed -n '/^Kinds:/,$ s/^  \([a-z0-9-]*\) .*/\1/p'
}

# Prints the engines of this build; "unix:" stands for a server.
_octopair_engines() {
    "$1" info 2>/dev/null | sed -n 's/^engines *//p' | sed 's/server (ADDRESS)/unix:/' | tr -d ,
}

# Prints the ids of the user's jobs on the server of OCTOPAIR_SERVER.
_octopair_jobs() {
    [[ -n $OCTOPAIR_SERVER ]] && timeout 2 "$1" status 2>/dev/null | sed -n 's/^\([0-9a-f-]\{36\}\) .*/\1/p'
}

_octopair() {
    local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}
    local subcommand=${COMP_WORDS[1]}
    local asked="--server --token-file --token-in-clear --server-user --tls --tls-authority --tls-certificate --tls-key --patience"
    COMPREPLY=()

    if ((COMP_CWORD == 1)); then
        mapfile -t COMPREPLY < <(compgen -W "cancel detect drain generate info replay result serve status submit --help --version" -- "$current")
        return
    fi
    case $previous in
        --stage) mapfile -t COMPREPLY < <(compgen -W "pairs objects features" -- "$current"); return ;;
        --adjacent) mapfile -t COMPREPLY < <(compgen -W "beyond-shared exclude include" -- "$current"); return ;;
        --up) mapfile -t COMPREPLY < <(compgen -W "y z" -- "$current"); return ;;
        --unit) mapfile -t COMPREPLY < <(compgen -W "mm cm dm m km in ft" -- "$current"); return ;;
        --same-parent) mapfile -t COMPREPLY < <(compgen -W "include exclude" -- "$current"); return ;;
        --objects)
            if [[ $subcommand == detect || $subcommand == submit ]]; then
                mapfile -t COMPREPLY < <(compgen -W "node triangle" -- "$current")
            fi
            return ;;
        --index-type) mapfile -t COMPREPLY < <(compgen -W "uint32 uint64" -- "$current"); return ;;
        --order) mapfile -t COMPREPLY < <(compgen -W "ascending octal" -- "$current"); return ;;
        --engine) mapfile -t COMPREPLY < <(compgen -W "$(_octopair_engines "$1")" -- "$current"); return ;;
        --log) mapfile -t COMPREPLY < <(compgen -W "text json" -- "$current"); return ;;
        --log-level) mapfile -t COMPREPLY < <(compgen -W "debug info warn error" -- "$current"); return ;;
        --margin | --limit | --threads | --workers | --seed | --frames | --patience | --listen | --metrics) return ;;
        --grace | --stall | --rank-timeout | --max-* | --server | --id | --owner | --wait) return ;;
        --keep) if [[ $subcommand == serve ]]; then return; fi ;;  # --keep of result has no value
        --state) mapfile -t COMPREPLY < <(compgen -d -- "$current"); return ;;
        --against | --exclude | --baseline | --report | --padding | --output | --stats | --config | --tokens | --roles | --token-file | --tls-*) mapfile -t COMPREPLY < <(compgen -f -- "$current"); return ;;
    esac
    case $subcommand in
        detect)
            if [[ $current == -* ]]; then
                mapfile -t COMPREPLY < <(compgen -W "--against --stage --adjacent --max-contacts --tolerance --duplicate-tolerance --min-depth --weld --exclude --same-parent --baseline --report --up --unit --objects --margin --padding --output --order
                    --index-type --count-only --events --limit --verify --fail-on-collision --engine --threads --workers --stats --quiet --help
                    --token-file --token-in-clear --server-user --tls --tls-authority --tls-certificate --tls-key --patience" -- "$current")
            else
                mapfile -t COMPREPLY < <(compgen -f -- "$current")
            fi ;;
        serve)
            mapfile -t COMPREPLY < <(compgen -W "--config --listen --engine --threads --workers --rank-timeout --grace --stall --max-objects
                --max-input --max-pairs --max-jobs --max-jobs-per-client --max-connections --max-connections-per-client --max-calls-per-client --max-seconds --max-memory
                --max-memory-per-client --max-state --max-state-per-client --state --keep --tls-certificate --tls-key --tls-client-authority --tokens --roles --metrics --log --log-level --quiet
                --help" -- "$current") ;;
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
        submit)
            if [[ $current == -* ]]; then
                mapfile -t COMPREPLY < <(compgen -W "--against --objects --margin --padding --order --limit --count-only
                    --id --quiet --help $asked" -- "$current")
            else
                mapfile -t COMPREPLY < <(compgen -f -- "$current")
            fi ;;
        status) mapfile -t COMPREPLY < <(compgen -W "$(_octopair_jobs "$1") --wait --json --owner --help $asked" -- "$current") ;;
        result)
            mapfile -t COMPREPLY < <(compgen -W "$(_octopair_jobs "$1") --output --keep --release --quiet --help $asked" -- "$current") ;;
        cancel) mapfile -t COMPREPLY < <(compgen -W "$(_octopair_jobs "$1") --json --owner --release --help $asked" -- "$current") ;;
        drain) mapfile -t COMPREPLY < <(compgen -W "--help $asked" -- "$current") ;;
        info) mapfile -t COMPREPLY < <(compgen -W "--help" -- "$current") ;;
    esac
}

complete -o filenames -F _octopair octopair
