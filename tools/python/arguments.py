"""The command line of a Python program of slewlab: an option or a choice that is not known is answered with the one that is near."""

import argparse
import ipaddress
import sys
from pathlib import Path
from urllib.parse import urlsplit


def known_names(name, known):
    """What would be right in place of a name that is not known, as the C++ side says it."""
    from core_module import core  # when it is needed: a command line that is right does not wait for it

    return core.known_names_text(name, list(known))


def port(text):
    """A port's number as an option gives it; 0 is any that is free."""
    if not text.isdigit() or int(text) > 65535:
        raise argparse.ArgumentTypeError(f"found '{text}', expected a number from 0 to 65535")
    return int(text)


def bus(text):
    """LCM's address of a bus."""
    address = urlsplit(text)
    try:
        is_one = address.scheme == "udpm" and ipaddress.IPv4Address(address.hostname or "").is_multicast and address.port != 0
    except ValueError:  # of the port, too
        is_one = False
    if not is_one:
        raise argparse.ArgumentTypeError(f"found '{text}', expected the address of a bus as udpm://239.255.76.67:7667?ttl=0")
    return text


def shell_command(text):
    """Not empty: an unset variable of a shell would else be no command at all, and ours would run in its place."""
    if not text.strip():
        raise argparse.ArgumentTypeError(f"found '{text}', expected a command of the shell")
    return text


def file_in_the_way(path):
    """The file that stands where a folder on the way to `path` would have to."""
    nearest = next(parent for parent in Path(path).absolute().parents if parent.exists())
    return None if nearest.is_dir() else nearest


def output_file(text):
    """A file that a command writes; the folder for it is made."""
    if text.endswith("/") or Path(text).is_dir():
        raise argparse.ArgumentTypeError(f"found '{text}', which is a folder, expected the name of a file to write")
    if found := file_in_the_way(text):
        raise argparse.ArgumentTypeError(f"found '{text}', of which {found} is a file, expected the name of a file to write")
    return Path(text)


def output_folder(text):
    """A folder that a command makes, or fills where it is there."""
    found = Path(text) if Path(text).is_file() else file_in_the_way(text)
    if found:
        what = "which is a file" if found == Path(text) else f"of which {found} is a file"
        raise argparse.ArgumentTypeError(f"found '{text}', {what}, expected the name of a folder, there or not")
    return Path(text)


class ArgumentParser(argparse.ArgumentParser):
    def parse_args(self, args=None, namespace=None):
        known = [name for name in self._option_string_actions if name.startswith("--")]
        words = sys.argv[1:] if args is None else list(args)
        for word in words[:words.index("--")] if "--" in words else words:
            name = str(word).partition("=")[0]
            if not name.startswith("--") or any(option.startswith(name) for option in known):
                continue
            self.error(f"'{name}' is no option of it, expected {known_names(name, known)}")
        return super().parse_args(args, namespace)

    def _check_value(self, action, value):
        if action.choices is not None and value not in action.choices:
            choices = [str(choice) for choice in action.choices]
            raise argparse.ArgumentError(action, f"found '{value}', expected {known_names(str(value), choices)}")
