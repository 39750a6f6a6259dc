// What an image finds in RAM before any of its own code has run.
#pragma once

/// C++20's constinit: the compiler refuses an object that it cannot initialise by itself.
#ifdef __clang__
#define EX9000_CONSTINIT [[clang::require_constant_initialization]]
#else
#define EX9000_CONSTINIT __constinit
#endif
