"""Speed against peers and limits: ratios in one run, never timed tests. `make bench` runs all."""
