// Nothing of its own: carries the precompiled header that all tests use.
