# Tab completion of the commands in tools and of lammps_dcm: source tools/completion.bash
# Options are those that --help names.

_dcm_options() {
  "$@" --help 2>/dev/null | grep -oE -- '(^|[^-a-zA-Z0-9])--?[a-z][-a-z]*' |
    grep -oE -- '--?[a-z][-a-z]*' | sort -u
}

_dcm_tool() {
  local tool=${COMP_WORDS[0]} word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}
  local root deck=''
  COMPREPLY=()
  if [ "$before" = -var ]; then
    # the variables of the deck that stands before
    for deck in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
      [ ! -f "$deck" ] || mapfile -t COMPREPLY < <(compgen -W "$(grep -oE \
        '\bvariable +[A-Za-z_0-9]+ +index|is_defined\(variable,[A-Za-z_0-9]+' "$deck" |
        sed -E 's/.*variable[ ,]+([A-Za-z_0-9]+).*/\1/' | sort -u)" -- "$word")
    done
    return
  fi
  case $word in
    -*) mapfile -t COMPREPLY < <(compgen -W "$(_dcm_options "$tool")" -- "$word") ;;
    *)
      mapfile -t COMPREPLY < <(compgen -f -- "$word")
      root=$(dirname "$(dirname "$(realpath "$(type -P "$tool")" 2>/dev/null)")")
      case $(basename "$tool") in
        run | sweep)
          mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(compgen -W \
            "$(cd "$root" && printf '%s\n' examples/*/in.*)" -- "$word") ;;
      esac ;;
  esac
}

_dcm_package() {
  local word=${COMP_WORDS[COMP_CWORD]}
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    mapfile -t COMPREPLY < <(compgen -W "$("${COMP_WORDS[0]}" --help 2>/dev/null |
      sed -n 's/^    \([a-z]*\) .*/\1/p')" -- "$word")
  elif [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(_dcm_options "${COMP_WORDS[0]}" "${COMP_WORDS[1]}")" \
      -- "$word")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
  fi
}

for _dcm_name in accuracy bench check coverage fuzz hard install-in-tree python run same-logs study sweep \
  test two-hosts; do
  complete -o filenames -F _dcm_tool "tools/$_dcm_name" "./tools/$_dcm_name"
done
complete -o filenames -F _dcm_package lammps-dcm
unset _dcm_name
