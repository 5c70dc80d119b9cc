# shellcheck shell=bash
# Completion of lapis for bash: `source` it, or put it into ~/.local/share/bash-completion/completions/ as lapis.

# _lapis_words: sets `command`, `action` and `given` (words behind them) from what is before the cursor, and `common` to the
# options that say which domain is meant.
_lapis_words() {
  local i word
  command="" action="" given=() common=()
  for ((i = 1; i < COMP_CWORD; ++i)); do
    word=${COMP_WORDS[i]}
    case $word in
      --domain | --namespace)
        common+=("$word" "${COMP_WORDS[i + 1]}")
        i=$((i + 1)) ;;
      --remap | --wait | --socket-buffer | --field | --seconds | --window | --topic | --exclude | --storage | --set | --config) i=$((i + 1)) ;;
      -*) ;;
      *)
        if [[ -z $command ]]; then
          command=$word
        elif [[ $command == params && -z $action ]]; then
          action=$word
        else
          given+=("$word")
        fi ;;
    esac
  done
}

# _lapis_candidates: prints what may stand at the cursor.
_lapis_candidates() {
  local program=${COMP_WORDS[0]} list=(topics --names --wait 1)
  if [[ ${COMP_WORDS[COMP_CWORD]} == -* ]]; then
    "$program" ${command:+"$command"} ${action:+"$action"} --help
    "$program" --help
  elif [[ -z $command ]]; then
    echo topics hz bw echo call pause resume home save goal params record doctor
  elif [[ $command == params && -z $action ]]; then
    echo list get set describe dump
  elif [[ ${COMP_WORDS[COMP_CWORD - 1]} == --topic || ${COMP_WORDS[COMP_CWORD - 1]} == --exclude ]]; then
    "$program" "${common[@]}" "${list[@]}"
  elif [[ ${#given[@]} -eq 0 ]]; then
    case $command in
      hz | bw | echo) "$program" "${common[@]}" "${list[@]}" ;;
      call) "$program" "${common[@]}" "${list[@]}" --services ;;
      params) "$program" "${common[@]}" "${list[@]}" --services | sed -n 's|/list_parameters$||p' ;;
    esac
  elif [[ $command == params ]]; then
    "$program" "${common[@]}" params list "${given[0]}" --wait 1
  fi
}

_lapis() {
  local command action given common words
  _lapis_words
  words=$(_lapis_candidates 2>/dev/null)
  if [[ ${COMP_WORDS[COMP_CWORD]} == -* ]]; then words=$(grep -oE -- '--[a-z][a-z-]*' <<<"$words" | sort -u); fi
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "${COMP_WORDS[COMP_CWORD]}")
  if [[ $command == record && ${#COMPREPLY[@]} -eq 0 ]]; then compopt -o default 2>/dev/null; fi
}

complete -F _lapis lapis
