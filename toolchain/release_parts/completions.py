"""Writes the completions of a program for bash and zsh from its help texts and its list of models."""

from __future__ import annotations

import shlex

from help_text import Help, Option

_FILE_VALUES = {"LINK", "DEVICE", "PATH", "FILE"}


def bash_completion(name: str, program: Help, subcommands: dict[str, Help], models: list[str]) -> str:
    """Returns a script that bash-completion loads when a user completes an argument of the program `name` for the first
    time in a shell."""
    commands = {"": program, **subcommands}
    lines = [
        f"# bash completion of {name}; generated from its help texts",
        "_ex9000_sim() {",
        "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command=",
        f"  case ${{COMP_WORDS[1]}} in {'|'.join(subcommands)}) command=${{COMP_WORDS[1]}} ;; esac",
        '  case "$command $before" in',
        *(line for command, help_of in commands.items() for line in _bash_values(command, help_of)),
        "  esac",
        "  case $word in",
        "    -*)",
        "      case $command in",
        *(f"        {_pattern(each)}) _ex9000_sim_words {shlex.quote(_names(h))} ;;" for each, h in commands.items()),
        "      esac",
        "      return ;;",
        "  esac",
        "  case $command in",
        *(line for command, help_of in commands.items() for line in _bash_positionals(command, help_of, bool(models))),
        "  esac",
        "}",
        "_ex9000_sim_words() {  # WORDS: completes to one of these words",
        '  mapfile -t COMPREPLY < <(compgen -W "$1" -- "${COMP_WORDS[COMP_CWORD]}")',
        "}",
        "_ex9000_sim_files() {  # completes to a file or a folder",
        "  compopt -o filenames 2>/dev/null",
        '  mapfile -t COMPREPLY < <(compgen -f -- "${COMP_WORDS[COMP_CWORD]}")',
        "}",
        *([f"_ex9000_sim_models={shlex.quote(' '.join(models))}"] if models else []),
        f"complete -F _ex9000_sim {name}",
    ]
    return _renamed("\n".join(lines) + "\n", name)


def _renamed(script: str, name: str) -> str:
    """Functions and variables begin with the name of the program."""
    return script.replace("_ex9000_sim", "_" + name.replace("-", "_"))


def _bash_values(command: str, help_of: Help) -> list[str]:
    lines = []
    for option in help_of.options:
        patterns = "|".join(f"'{command} {name}'" for name in option.names)
        if option.value in _FILE_VALUES:
            lines.append(f"    {patterns}) _ex9000_sim_files; return ;;")
        elif option.choices() and not option.value.startswith("["):
            lines.append(f"    {patterns}) _ex9000_sim_words {shlex.quote(' '.join(option.choices()))}; return ;;")
        elif option.choices():
            # The value is optional, so the word can also be another option or a positional argument.
            words = shlex.quote(" ".join(option.choices()))
            lines.append(f"    {patterns}) _ex9000_sim_words {words}; [ ${{#COMPREPLY[@]}} -eq 0 ] || return ;;")
        elif option.value:
            lines.append(f"    {patterns}) return ;;")
    return lines


def _bash_positionals(command: str, help_of: Help, has_models: bool) -> list[str]:
    names = {positional.names[0] for positional in help_of.positionals}
    subcommands = "".join(f"{name} " for name in help_of.subcommands)
    actions = []
    if has_models and names & {"MODULE", "MODEL"}:
        actions.append(f'_ex9000_sim_words "{subcommands}$_ex9000_sim_models"')
    elif subcommands:
        actions.append(f'_ex9000_sim_words "{subcommands.strip()}"')
    if names & ({"MODULE", "FILE"} if has_models else {"PORT", "FILE"}):
        actions.append("[ ${#COMPREPLY[@]} -ne 0 ] || _ex9000_sim_files")
    return [f"    {_pattern(command)}) {'; '.join(actions) or ':'} ;;"]


def _pattern(command: str) -> str:
    return command or "''"


def _names(help_of: Help) -> str:
    return " ".join(name for option in help_of.options for name in option.names)


def zsh_completion(name: str, program: Help, subcommands: dict[str, Help], models: list[str]) -> str:
    """Returns a function that zsh loads from one of the folders in `fpath`."""
    lines = [
        f"#compdef {name}",
        f"# generated from the help texts of {name}",
        "_ex9000_sim_modules() {",
        f"  compadd -- {' '.join(models)}",
        "}",
        "_ex9000_sim_arguments() {",
        f"  compadd -- {' '.join(subcommands)}",
        *(["  _ex9000_sim_modules", "  _files -g '*.(yaml|yml|json)'"] if models else []),
        "}",
        "case $words[2] in",
    ]
    for command, help_of in subcommands.items():
        lines += [f"  {command})", *_zsh_arguments(help_of, f"1:command:({command})", offset=2), "    ;;"]
    lines += ["  *)", *_zsh_arguments(program, "*:module:_ex9000_sim_arguments", offset=None), "    ;;", "esac"]
    return _renamed("\n".join(lines) + "\n", name)


def _zsh_arguments(help_of: Help, first: str, offset: int | None) -> list[str]:
    specs = [first]
    for option in help_of.options:
        specs += _zsh_option(option)
    if offset is not None:
        for number, positional in enumerate(help_of.positionals, start=offset):
            place = "*" if positional.repeats else str(number)
            action = "_files" if positional.names[0] in ("FILE", "PORT") else "_ex9000_sim_modules"
            specs.append(f"{place}:{positional.names[0]}:{action}")
    *most, last = [f"      {shlex.quote(spec)}" for spec in specs]
    return ["    _arguments \\", *(f"{spec} \\" for spec in most), last]


def _zsh_option(option: Option) -> list[str]:
    text = option.text
    for special in "\\[]:":
        text = text.replace(special, "\\" + special)
    value = ""
    if option.value:
        action = "_files" if option.value in _FILE_VALUES else ""
        if option.choices():
            action = f"({' '.join(option.choices())})"
        colon = "::" if option.value.startswith("[") else ":"
        value = f"{colon}{option.value.strip('[]').replace(':', chr(92) + ':')}:{action}"
    repeats = "*" if option.repeats else ""
    return [f"{repeats}{name}[{text}]{value}" for name in option.names]
