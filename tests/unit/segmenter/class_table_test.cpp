#include "segmenter/core/class_table.hpp"

#include <gtest/gtest.h>

namespace lapis::segmenter {
namespace {

TEST(ClassTable, WhatItDoesNotNameIsUnlabelled) {
  const ClassTable table({{0, 7}, {3, 300}});
  EXPECT_EQ(table.size(), 4u);
  EXPECT_EQ(table.label_of(0), 7);
  EXPECT_EQ(table.label_of(1), 0);
  EXPECT_EQ(table.label_of(3), 300);
  EXPECT_EQ(table.label_of(4), 0);
  EXPECT_EQ(ClassTable().label_of(0), 0);
}

}  // namespace
}  // namespace lapis::segmenter
