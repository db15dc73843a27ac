"""How a check is written and run.

A check is a function of a finished map, marked with @check, that asserts and returns in words what it has seen. It
raises Skip where there is nothing to be checked.
"""

import traceback

CHECKS = []


class Skip(Exception):
    """Says why a check does not apply."""


def check(function):
    """Marks a function as a check; checks run in the order in which they are defined."""
    CHECKS.append(function)
    return function


def need(condition, reason):
    """Skips the check unless the condition holds."""
    if not condition:
        raise Skip(reason)


def run_all(finished):
    """Runs all checks on a finished map, one line each; returns how many failed."""
    failed = 0
    for function in CHECKS:
        name = function.__name__.replace("_", " ")
        try:
            print(f"ok    {finished.name}: {name}: {function(finished)}", flush=True)
        except Skip as reason:
            print(f"skip  {finished.name}: {name}: {reason}", flush=True)
        except Exception as error:  # whatever a reader raises is a failed check
            failed += 1
            at = traceback.extract_tb(error.__traceback__)[-1]
            line = f"{type(error).__name__} {error} ({at.name}, line {at.lineno}: {at.line})"
            print(f"FAIL  {finished.name}: {name}: {' '.join(line.split())}", flush=True)
    return failed
