"""One script per claim; `python -m benchmarks` runs all and writes RESULTS.md."""
