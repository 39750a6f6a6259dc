#include <gtest/gtest.h>

#include <string>

#include "sim/front_ends/panel/loopback.hpp"

namespace ex9000::sim {
namespace {

TEST(Loopback, AcceptsItsNamesOnlyWithThePort) {
  const Loopback here(9042);
  for (const std::string name : {"127.0.0.1", "localhost"}) {
    EXPECT_TRUE(here.is_host(name + ":9042"));
    EXPECT_TRUE(here.is_origin("http://" + name + ":9042"));
    EXPECT_FALSE(here.is_host(name));
    EXPECT_FALSE(here.is_host(name + ":80"));
    EXPECT_FALSE(here.is_origin("https://" + name + ":9042"));
  }
  EXPECT_FALSE(here.is_host("example.org:9042"));
}

TEST(Loopback, AcceptsItsNamesWithOrWithoutThePortAtPort80) {
  const Loopback here(80);
  for (const std::string name : {"127.0.0.1", "localhost"}) {
    for (const std::string port : {"", ":80"}) {
      EXPECT_TRUE(here.is_host(name + port));
      EXPECT_TRUE(here.is_origin("http://" + name + port));
    }
    EXPECT_FALSE(here.is_host(name + ":8080"));
    EXPECT_FALSE(here.is_origin(name));
  }
  EXPECT_FALSE(here.is_host("example.org"));
}

}  // namespace
}  // namespace ex9000::sim
