"""The survey's report, what a surveyor signs: material -> document with figures -> HTML or PDF."""
