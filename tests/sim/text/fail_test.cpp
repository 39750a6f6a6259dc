// Tests that `with_place` adds the place of an error to the message of the exception, and returns the result
// of the action if there is no error.
#include "sim/text/fail.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace ex9000::sim {
namespace {

template <class Exception>
std::string message_with_place() {
  try {
    with_place("--pty: ", [] { throw Exception("is in use"); });
  } catch (const Exception& error) {
    return error.what();
  }
  return "";
}

TEST(WithPlace, AddsThePlaceToTheMessagesOfInvalidArgumentAndRuntimeError) {
  EXPECT_EQ(message_with_place<std::invalid_argument>(), "--pty: is in use");
  EXPECT_EQ(message_with_place<std::runtime_error>(), "--pty: is in use");
}

TEST(WithPlace, ReturnsTheResult) {
  EXPECT_EQ(with_place("--pty: ", [] { return 5; }), 5);
}

}  // namespace
}  // namespace ex9000::sim
