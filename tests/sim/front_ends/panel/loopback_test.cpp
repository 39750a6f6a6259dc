#include <gtest/gtest.h>

#include <string>

#include "sim/front_ends/panel/loopback.hpp"

namespace ex9000::sim {
namespace {

TEST(Loopback, ANameOfThisMachineIsAcceptedWithAnyPortOrNone) {
  for (const std::string name : {"127.0.0.1", "localhost"}) {
    for (const char* port : {"", ":80", ":8080", ":9042", ":65535"}) {
      EXPECT_TRUE(is_loopback_host(name + port)) << name << port;
    }
  }
}

TEST(Loopback, AnotherNameIsRefused) {
  for (const char* host :
       {"", ":9042", "example.org", "example.org:9042", "localhost.example.org", "localhost:", "localhost:x",
        "localhost:9042.example.org", "localhost:9042:9042", "127.0.0.1.example.org", "127.0.0.2:9042",
        "user@localhost", "LOCALHOST@example.org"}) {
    EXPECT_FALSE(is_loopback_host(host)) << host;
  }
}

TEST(Loopback, AnOriginIsAcceptedOnlyWithTheHostOfTheRequest) {
  EXPECT_TRUE(is_origin_of("http://localhost:8080", "localhost:8080"));
  EXPECT_TRUE(is_origin_of("http://127.0.0.1", "127.0.0.1"));
  for (const char* origin : {"http://localhost:3000", "http://localhost", "https://localhost:9042",
                             "localhost:9042", "http://127.0.0.1:9042", "null", ""}) {
    EXPECT_FALSE(is_origin_of(origin, "localhost:9042")) << origin;
  }
}

}  // namespace
}  // namespace ex9000::sim
