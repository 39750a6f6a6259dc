// CMake needs a source file to build the precompiled header of the GoogleTest programs. This file contains no
// code.
