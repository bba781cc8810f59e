"""Truth between snapshots: the reference at any time, with the uncertainty of not having looked."""
