"""The implementation of tests/bench/instructions."""
