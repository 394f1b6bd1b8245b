"""Reads the files of procman (.pmd, .cfg), from which scripts/launch starts processes.

    group "map" {                       # groups may be nested; they only structure the file
        cmd "map-server" {
            exec = "${VISMAP_BIN}/vismap-map-server --threads ${THREADS:-2}";
            auto_respawn = "true";      # restart it when it ends
            host = "localhost";         # or "deputy"; default: this computer
            stop_signal = "15";
            stop_time_allowed = "30";   # [s]
        }
    }
    script "go" { start cmd "map-server"; }   # accepted, but not run
"""
import dataclasses
import re
import shlex


class ConfigError(Exception):
    """An error in the file, as "FILE:LINE: sentence"."""


@dataclasses.dataclass
class Command:
    """One command of the file."""
    name: str
    where: str  # FILE:LINE of the cmd
    exec: str = ""
    host: str = ""
    group: str = ""
    description: str = ""
    auto_respawn: bool = False
    stop_signal: int = 15
    stop_time_allowed: float = 30.0


TOKEN = re.compile(r'\s+|#[^\n]*|"(?:[^"\\\n]|\\.)*"|[A-Za-z_][A-Za-z0-9_]*|[0-9.]+|[{}=;,]')
VARIABLE = re.compile(r"\$\{([^}]*)\}")
NAME = re.compile(r"([A-Za-z_][A-Za-z0-9_]*)(?::-(.*))?")
ASSIGNMENT = re.compile(r"([A-Za-z_][A-Za-z0-9_]*)=(.*)")


class Tokens:
    """The tokens of the file, each with its line."""

    def __init__(self, text, path):
        self.path = path
        self.line = 1
        self.words = []
        at = 0
        while at < len(text):
            match = TOKEN.match(text, at)
            if not match:
                raise ConfigError(f"{path}:{self.line}: unexpected {text[at:at + 20].splitlines()[0]!r}")
            word = match.group()
            if not word[0].isspace() and word[0] != "#":
                self.words.append((word, self.line))
            self.line += word.count("\n")
            at = match.end()
        self.words.append(("end of file", self.line))
        self.words.reverse()

    def peek(self):
        return self.words[-1][0]

    def next(self, expected="more"):
        if len(self.words) == 1:
            self.fail(expected, self.peek())
        word, self.line = self.words.pop()
        return word

    def fail(self, expected, found):
        line = self.words[-1][1] if len(self.words) == 1 else self.line
        raise ConfigError(f"{self.path}:{line}: expected {expected}, found {found}")

    def take(self, expected):
        word = self.next(f"'{expected}'")
        if word != expected:
            self.fail(f"'{expected}'", word)

    def string(self, what):
        word = self.next(f"{what} in double quotes")
        if not word.startswith('"'):
            self.fail(f"{what} in double quotes", word)
        return re.sub(r"\\(.)", r"\1", word[1:-1])


def parse_value(tokens, key, text):
    """Converts the value of one attribute of a cmd."""
    try:
        if key == "auto_respawn":
            return {"true": True, "1": True, "false": False, "0": False}[text.lower()]
        if key == "stop_signal":
            return int(text)
        if key == "stop_time_allowed":
            return float(text)
    except (KeyError, ValueError):
        tokens.fail(f"a valid value of {key}", f'"{text}"')
    return text


def parse_command(tokens, group):
    name = tokens.string("the name of a cmd")
    command = Command(name, f"{tokens.path}:{tokens.line}", group=group)
    if not re.fullmatch(r"[A-Za-z0-9_.-]+", name):
        tokens.fail("a name of letters, digits, '_', '.', '-'", f'"{name}"')
    tokens.take("{")
    known = ("exec", "host", "deputy", "auto_respawn", "stop_signal", "stop_time_allowed", "description")
    while tokens.peek() != "}":
        key = tokens.next()
        if key not in known:
            tokens.fail(" or ".join(known), key)
        tokens.take("=")
        value = parse_value(tokens, key, tokens.string(f"the value of {key}"))
        setattr(command, "host" if key == "deputy" else key, value)
        tokens.take(";")
    tokens.take("}")
    if not command.exec:
        raise ConfigError(f'{command.where}: the cmd "{name}" has no exec')
    return command


def skip_script(tokens):
    tokens.string("the name of a script")
    tokens.take("{")
    while tokens.next() != "}":
        pass


def parse_body(tokens, group, commands):
    """Parses the content of the file or of a group."""
    while tokens.peek() not in ("}", "end of file"):
        word = tokens.next()
        if word == "group":
            name = tokens.string("the name of a group")
            tokens.take("{")
            parse_body(tokens, f"{group}/{name}" if group else name, commands)
            tokens.take("}")
        elif word == "cmd":
            command = parse_command(tokens, group)
            if command.name in (one.name for one in commands):
                raise ConfigError(f'{command.where}: there is already a cmd "{command.name}"')
            commands.append(command)
        elif word == "script":
            skip_script(tokens)
        else:
            tokens.fail("group, cmd or script", word)


def parse(text, path):
    """All commands, in the order of the file. Raises ConfigError."""
    tokens = Tokens(text, path)
    commands = []
    parse_body(tokens, "", commands)
    if len(tokens.words) > 1:
        tokens.next()
        tokens.fail("group, cmd or script", "}")
    if not commands:
        raise ConfigError(f"{path}: the file has no cmd")
    return commands


def expand(command, variables):
    """(environment, arguments) of a command: replaces ${NAME} and ${NAME:-default}, and moves leading NAME=VALUE to the
    environment. No shell is used."""
    def value(match):
        name = NAME.fullmatch(match.group(1))
        if name and name.group(1) in variables:
            return variables[name.group(1)]
        if name and name.group(2) is not None:
            return name.group(2)
        raise ConfigError(f'{command.where}: cmd "{command.name}" uses ${{{match.group(1)}}}, which is not set; '
                          "set it in the environment or with --set NAME=VALUE")
    text = VARIABLE.sub(value, command.exec)
    try:
        words = shlex.split(text)
    except ValueError as error:
        raise ConfigError(f'{command.where}: exec of cmd "{command.name}": {error}') from error
    environment = {}
    while words and ASSIGNMENT.fullmatch(words[0]):
        name, content = ASSIGNMENT.fullmatch(words.pop(0)).groups()
        environment[name] = content
    if not words:
        raise ConfigError(f'{command.where}: exec of cmd "{command.name}" has no program')
    return environment, words
