// EX9000_CONSTINIT marks a variable that must have its initial value before any code of the program runs.
#pragma once

/// Like C++20's constinit: the compiler rejects a variable that it cannot initialise at compile time.
#ifdef __clang__
#define EX9000_CONSTINIT [[clang::require_constant_initialization]]
#else
#define EX9000_CONSTINIT __constinit
#endif
