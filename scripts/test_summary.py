#!/usr/bin/env python3
"""Says how a run of ctest ended: the output of the tests that failed, the reasons of those that were skipped, and how
many passed, failed and were skipped. Exits 1 when a test failed or none ran. Usage: test_summary.py JUNIT_FILE
"""
import collections
import re
import sys
import xml.etree.ElementTree


def skip_reason(output):
    """What a GoogleTest wrote behind GTEST_SKIP(); paths in it stand for themselves."""
    found = re.search(r": Skipped\n(.*?)\n+(?:\[|$)", output, re.DOTALL)
    return " ".join(found.group(1).split()) if found else "The test gave no reason."


def read_results(path):
    """The tests of a JUnit file of ctest by how they ended: {"passed": [(name, output)], ...}."""
    results = collections.defaultdict(list)
    for case in xml.etree.ElementTree.parse(path).getroot().iter("testcase"):
        output = case.findtext("system-out") or ""
        if case.find("skipped") is not None and "[  SKIPPED ]" in output:
            end = "skipped"
        elif case.get("status") == "run" and case.find("failure") is None:
            end = "passed"
        elif case.get("status") == "disabled":
            end = "skipped"
        else:
            end = "failed"
        results[end].append((case.get("name"), output))
    return results


def main():
    results = read_results(sys.argv[1])
    for name, output in results["failed"]:
        print(f"----- {name} failed; its output:\n{output.rstrip()}\n-----")
    reasons = collections.Counter(skip_reason(output) for _, output in results["skipped"])
    if reasons:
        print("Tests were skipped for these reasons:")
    for reason, count in reasons.most_common():
        print(f"{count:5d}  {reason}")
    for name, _ in results["failed"]:
        print(f"This test failed: {name}")
    counts = {end: len(results[end]) for end in ("passed", "failed", "skipped")}
    print(", ".join(f"{count} {end}" for end, count in counts.items()))
    return 1 if counts["failed"] or not counts["passed"] + counts["skipped"] else 0


if __name__ == "__main__":
    sys.exit(main())
