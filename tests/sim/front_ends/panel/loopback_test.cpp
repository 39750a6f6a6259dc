#include <gtest/gtest.h>

#include <string>

#include "sim/front_ends/panel/loopback.hpp"

namespace ex9000::sim {
namespace {

TEST(Loopback, AtAPortOtherThan80ANameIsAcceptedOnlyWithThePort) {
  for (const std::string name : {"127.0.0.1", "localhost"}) {
    EXPECT_TRUE(is_loopback_host(name + ":9042", 9042));
    EXPECT_TRUE(is_loopback_origin("http://" + name + ":9042", 9042));
    EXPECT_FALSE(is_loopback_host(name, 9042));
    EXPECT_FALSE(is_loopback_host(name + ":80", 9042));
    EXPECT_FALSE(is_loopback_origin("https://" + name + ":9042", 9042));
  }
  EXPECT_FALSE(is_loopback_host("example.org:9042", 9042));
}

TEST(Loopback, AtPort80ANameIsAcceptedWithOrWithoutThePort) {
  for (const std::string name : {"127.0.0.1", "localhost"}) {
    for (const std::string port : {"", ":80"}) {
      EXPECT_TRUE(is_loopback_host(name + port, 80));
      EXPECT_TRUE(is_loopback_origin("http://" + name + port, 80));
    }
    EXPECT_FALSE(is_loopback_host(name + ":8080", 80));
    EXPECT_FALSE(is_loopback_origin(name, 80));
  }
  EXPECT_FALSE(is_loopback_host("example.org", 80));
}

}  // namespace
}  // namespace ex9000::sim
