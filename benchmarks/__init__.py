"""Speed relative to peers and limits: ratios within one run. `make bench` runs all benchmarks."""
