# Fish completion for octopair.
#
# Subcommands, options and their arguments come from the help of the program, so they are those of the installed program. Only
# the values of an option are listed here, in __octopair_values. tests/cli/completion_test.py compares the shells.

# PROGRAM SECTION [SUBCOMMAND]: prints a section of the help, such as Options, as lines "NAME|ARGUMENT|DESCRIPTION". A line of
# the help may continue on the next line, which then has the description.
function __octopair_section
    $argv[1] $argv[3..-1] --help 2>/dev/null | awk -F '  +' -v section="$argv[2]:" '
        function finish() { if (name) print name "|" argument "|" text; name = "" }
        /^[A-Z]/ { inside = $0 == section }
        !inside { next }
        /^  [^ ]/ {
            finish()
            split($2, head, " ")
            sub(/^-h,/, "", head[1])
            name = head[1]
            argument = head[2] ~ /^[A-Z][A-Za-z.:]*$/ && head[2] !~ /:$|^REQUIRED$/ ? head[2] : ""
            text = $3
        }
        /^   / { text = $2 }
        END { finish() }'
end

# PROGRAM SECTION [SUBCOMMAND]: prints the names of a section with their descriptions, as fish expects candidates.
function __octopair_names
    __octopair_section $argv | string replace -r '^([^|]*)\|[^|]*\|' '$1\t'
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
        case '--up:*'
            printf '%s\n' y z
        case '--unit:*'
            printf '%s\n' mm cm dm m km in ft
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
        case --output:FILE
            __octopair_files npy csv jsonl
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
    set -l options (__octopair_section $program Options $subcommand)
    set -l positional (__octopair_section $program Positionals $subcommand | string replace -r '\|.*' '')
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
    if set -q words[2]
        __octopair_subcommand $words
    else
        __octopair_names $words[1] Subcommands
        __octopair_names $words[1] Options
    end
end

complete -c octopair -f -a '(__octopair_complete)'
