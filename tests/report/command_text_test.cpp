#include "report/command_text.h"

#include <gtest/gtest.h>

namespace taut {
namespace {

TEST(CommandText, QuotesOnlyWhatAShellWouldTakeApart) {
  EXPECT_EQ(command_text({"taut", "solve", "a/b.json", "--set", "time.steps=10"}),
            "taut solve a/b.json --set time.steps=10");
  EXPECT_EQ(command_text({"taut", "cells=[4,4]", "a b", ""}), "taut 'cells=[4,4]' 'a b' ''");
  EXPECT_EQ(command_text({"it's"}), "'it'\\''s'");
}

}  // namespace
}  // namespace taut
