"""``python -m vibeam`` is the command ``vibeam``."""

from __future__ import annotations

INTERRUPTED = 130


def main() -> None:
    """The entry point; Ctrl-C while the command is being imported ends it like one later."""
    try:
        from vibeam.cli.main import main as command

        command()
    except KeyboardInterrupt:
        raise SystemExit(INTERRUPTED) from None


if __name__ == "__main__":
    main()
