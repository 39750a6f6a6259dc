"""What tests/bench/instructions is made of."""
