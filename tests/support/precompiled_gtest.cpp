// CMake builds the precompiled header of the GoogleTest programs together with this file. It contains no
// code.
