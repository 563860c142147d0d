# Bash completion for octopair.
#
# Subcommands, options and their arguments come from the help of the program, so they are those of the installed program. Only
# the values of an option are listed here, in _octopair_values. tests/cli/completion_test.py compares the shells.

# PROGRAM KIND [SUBCOMMAND]: prints entries of the help as lines "NAME|ARGUMENT|DESCRIPTION". KIND: Options, Arguments, or the
# section Subcommands or Kinds. An option with a short name has two lines.
_octopair_entries() {
    "$1" ${3:+"$3"} --help 2>/dev/null | awk -F '  +' -v wanted="$2" '
        function finish(  i) {
            for (i = 1; i in names; ++i) if (kind == wanted) print names[i] "|" argument "|" text
            delete names
        }
        /^[A-Z]/ { finish(); section = substr($0, 1, length($0) - 1) }
        /^   / { text = text " " $2 }
        /^  [^ ]/ {
            finish()
            split($2, head, " ")
            text = $3
            kind = $2 ~ /^-/ ? "Options" : section ~ /^(Subcommands|Kinds|Examples)$/ ? section : "Arguments"
            long = head[1] ~ /,$/ ? 2 : 1
            argument = head[long + 1]
            for (i = 1; i <= long; ++i) {
                names[i] = head[i]
                sub(/(,|\.\.\.)$/, "", names[i])
            }
            sub(/\.\.\.$/, "", argument)
        }
        END { finish() }'
}

# The same, but prints only the names.
_octopair_names() {
    _octopair_entries "$@" | cut -d '|' -f 1
}

# Prints the engines of this build; "unix:" stands for a server.
_octopair_engines() {
    "$1" info 2>/dev/null | sed -n 's/^engines *//p' | sed 's/server (ADDRESS)/unix:/' | tr -d ,
}

# Prints the ids of the user's jobs on the server of OCTOPAIR_SERVER.
_octopair_jobs() {
    [[ -n $OCTOPAIR_SERVER ]] && timeout 2 "$1" status 2>/dev/null | sed -n 's/^\([0-9a-f-]\{36\}\) .*/\1/p'
}

# CURRENT ENDING...: prints the folders, and the files with one of the endings. Without endings, prints all files.
_octopair_files() {
    local current=$1 ending
    shift
    if (($# == 0)); then
        compgen -f -- "$current"
        return
    fi
    compgen -d -- "$current"
    for ending in "$@"; do compgen -f -X "!*.$ending" -- "$current"; done
}

# PROGRAM OPTION ARGUMENT CURRENT: prints the values of an option, or of the argument ARGUMENT of a subcommand.
_octopair_values() {
    local words=
    case $2:$3 in
        --stage:*) words="pairs objects features" ;;
        --adjacent:*) words="beyond-shared exclude include" ;;
        --classes:*) words="clearance collision touching penetrating contained duplicate undecided" ;;
        --up:*) words="y z" ;;
        --unit:*) words="um mm cm dm m km in ft" ;;
        --same-parent:*) words="include exclude" ;;
        --objects:WHAT) words="node triangle" ;;
        --index-type:*) words="uint32 uint64" ;;
        --order:*) words="ascending octal" ;;
        --log:*) words="text json" ;;
        --log-level:*) words="debug info warn error" ;;
        --engine:*) words=$(_octopair_engines "$1") ;;
        :KIND) words=$(_octopair_names "$1" Kinds generate) ;;
        :ID) words=$(_octopair_jobs "$1") ;;
        -o:FILE | --output:FILE) _octopair_files "$4" npy csv jsonl bcf ;;
        *:DIR) compgen -d -- "$4" ;;
        *:FILE | :INPUT) _octopair_files "$4" ;;
        *:*.*) _octopair_files "$4" "${3##*.}" ;;
    esac
    [[ -z $words ]] || compgen -W "$words" -- "$4"
}

# Completes an option or an argument of a subcommand. Arguments: PROGRAM SUBCOMMAND CURRENT, and all words before CURRENT.
_octopair_subcommand() {
    local program=$1 subcommand=$2 current=$3 name argument positional option= given=0 word
    local -A argument_of=()
    shift 3
    while IFS='|' read -r name argument _; do argument_of[$name]=$argument; done < <(_octopair_entries "$program" Options "$subcommand")
    read -r positional < <(_octopair_names "$program" Arguments "$subcommand")
    for word in "$@"; do
        if [[ -n $option ]]; then
            option=
        elif [[ $word == -* ]]; then
            [[ -z ${argument_of[$word]-} ]] || option=$word
        else
            given=$((given + 1))
        fi
    done
    if [[ -n $option ]]; then
        _octopair_values "$program" "$option" "${argument_of[$option]}" "$current"
    elif [[ $current == -* ]]; then
        compgen -W "${!argument_of[*]}" -- "$current"
    elif [[ $positional == INPUT ]] || ((given == 0)) && [[ -n $positional ]]; then
        _octopair_values "$program" "" "$positional" "$current"
    else
        compgen -W "${!argument_of[*]}" -- "$current"
    fi
}

_octopair() {
    local program=$1 current=${COMP_WORDS[COMP_CWORD]} names
    if ((COMP_CWORD == 1)) || [[ ${COMP_WORDS[1]} == help ]]; then
        names=$(_octopair_names "$program" Subcommands)
        ((COMP_CWORD > 1)) || names+=" $(_octopair_names "$program" Options)"
        mapfile -t COMPREPLY < <(compgen -W "$names" -- "$current")
        return
    fi
    mapfile -t COMPREPLY < <(_octopair_subcommand "$program" "${COMP_WORDS[1]}" "$current" "${COMP_WORDS[@]:2:COMP_CWORD-2}")
}

complete -o filenames -F _octopair octopair
