# Fish completion for octopair.
#
# Subcommands, options and their arguments come from the help of the program, so they are those of the installed program. Only
# the values of an option are listed here, in __octopair_values. tests/cli/completion_test.py compares the shells.

# PROGRAM KIND [SUBCOMMAND]: prints entries of the help as lines "NAME|ARGUMENT|DESCRIPTION". KIND: Options, Arguments, or the
# section Subcommands or Kinds. An option with a short name has two lines.
function __octopair_entries
    $argv[1] $argv[3..-1] --help 2>/dev/null | awk -F '  +' -v wanted="$argv[2]" '
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
end

# PROGRAM KIND [SUBCOMMAND]: prints the names with their descriptions, as fish expects candidates.
function __octopair_names
    __octopair_entries $argv | string replace -r '^([^|]*)\|[^|]*\|' '$1\t'
end

# Prints the engines of this build; "unix:" stands for a server.
function __octopair_engines
    $argv[1] info 2>/dev/null | string match -rg '^engines +(.*)' | string replace 'server (ADDRESS)' unix: |
        string split ', '
end

# Prints the ids of the user's jobs on the server of OCTOPAIR_SERVER.
function __octopair_jobs
    test -n "$OCTOPAIR_SERVER"
    and timeout 2 $argv[1] status 2>/dev/null | string match -rg '^([0-9a-f-]{36}) '
end

# ENDING...: prints the folders, and the files with one of the endings. Without endings, prints all files.
function __octopair_files
    __fish_complete_path (commandline -ct) | string match -r '^[^\t]*(?:/|'(string join '|' -- \\.$argv)')(?:\t.*)?$'
end

# PROGRAM OPTION ARGUMENT: prints the values of an option, or of the argument ARGUMENT of a subcommand.
function __octopair_values
    switch "$argv[2]:$argv[3]"
        case '--stage:*'
            printf '%s\n' pairs objects features
        case '--adjacent:*'
            printf '%s\n' beyond-shared exclude include
        case '--classes:*'
            printf '%s\n' clearance collision touching penetrating contained duplicate undecided
        case '--up:*'
            printf '%s\n' y z
        case '--unit:*'
            printf '%s\n' um mm cm dm m km in ft
        case '--same-parent:*'
            printf '%s\n' include exclude
        case --objects:WHAT
            printf '%s\n' node triangle
        case '--index-type:*'
            printf '%s\n' uint32 uint64
        case '--order:*'
            printf '%s\n' ascending octal
        case '--log:*'
            printf '%s\n' text json
        case '--log-level:*'
            printf '%s\n' debug info warn error
        case '--engine:*'
            __octopair_engines $argv[1]
        case ':KIND'
            __octopair_names $argv[1] Kinds generate
        case ':ID'
            __octopair_jobs $argv[1]
        case -o:FILE --output:FILE
            __octopair_files npy csv jsonl bcf
        case '*:DIR'
            __fish_complete_directories (commandline -ct)
        case '*:FILE' ':INPUT'
            __fish_complete_path (commandline -ct)
        case '*:*.*'
            __octopair_files (string split . -- $argv[3])[-1]
    end
end

# Prints the candidates for the current word: the value of an option, an option, or an argument of the subcommand.
function __octopair_subcommand
    set -l program $argv[1]
    set -l subcommand $argv[2]
    set -l options (__octopair_entries $program Options $subcommand)
    set -l positional (__octopair_entries $program Arguments $subcommand | string replace -r '\|.*' '')
    set -l pending
    set -l given 0
    for word in $argv[3..-1]
        if set -q pending[1]
            set pending
        else if string match -q -- '-*' $word
            set pending $word (string match -rg -- '^'$word'\|([^|]+)\|' $options)
            set -q pending[2]; or set pending
        else
            set given (math $given + 1)
        end
    end
    if set -q pending[2]
        __octopair_values $program $pending
    else if string match -q -- '-*' (commandline -ct)
        __octopair_names $program Options $subcommand
    else if test "$positional" = INPUT; or test $given -eq 0 -a -n "$positional"
        __octopair_values $program '' $positional
    else
        __octopair_names $program Options $subcommand
    end
end

function __octopair_complete
    set -l words (commandline -opc)
    if test "$words[2]" = help
        __octopair_names $words[1] Subcommands
    else if set -q words[2]
        __octopair_subcommand $words
    else
        __octopair_names $words[1] Subcommands
        __octopair_names $words[1] Options
    end
end

complete -c octopair -f -a '(__octopair_complete)'
