#include "core/result.h"

#include <gtest/gtest.h>

namespace taut {
namespace {

TEST(Status, SurvivesTheRoundTripThroughText) {
  for (Status status : {Status::solved, Status::infeasible, Status::unbounded, Status::stalled, Status::limit_point,
                        Status::iteration_limit, Status::time_limit, Status::not_finite, Status::interrupted}) {
    EXPECT_EQ(status_from_string(to_string(status)), status);
  }
}

TEST(Status, RejectsOtherTexts) {
  EXPECT_THROW(status_from_string(""), std::invalid_argument);
  EXPECT_THROW(status_from_string("Solved"), std::invalid_argument);
  EXPECT_THROW(to_string(static_cast<Status>(99)), std::invalid_argument);
}

TEST(Counts, AddEntryByEntry) {
  Counts counts{1, 2, 3, 4, 5, 6, 7, 8};
  counts += Counts{10, 20, 30, 40, 50, 60, 70, 80};
  EXPECT_EQ(counts.outer, 11);
  EXPECT_EQ(counts.linear_solves, 22);
  EXPECT_EQ(counts.factorizations, 33);
  EXPECT_EQ(counts.pivoted_factorizations, 44);
  EXPECT_EQ(counts.inner_iterations, 55);
  EXPECT_EQ(counts.symbolic_analyses, 66);
  EXPECT_EQ(counts.matrix_allocations, 77);
  EXPECT_EQ(counts.function_evaluations, 88);
}

TEST(Timings, AddEntryByEntry) {
  Timings timings{1, 2, 3, 4, 5};
  timings += Timings{0.5, 0.25, 0.125, 1, 2};
  EXPECT_EQ(timings.total, 1.5);
  EXPECT_EQ(timings.assembly, 2.25);
  EXPECT_EQ(timings.analysis, 3.125);
  EXPECT_EQ(timings.factorization, 5);
  EXPECT_EQ(timings.solve, 7);
}

}  // namespace
}  // namespace taut
