#include "study/pareto.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace taut {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(ParetoFront, KeepsWhatNothingBeatsInCostAndError) {
  // By hand: (1, 9) is cheapest; (2, 4) is better and dearer; (3, 5) is beaten by (2, 4); (4, 1) is best.
  EXPECT_THAT(pareto_front({{3, 5}, {4, 1}, {1, 9}, {2, 4}}), ElementsAre(2, 3, 1));
}

TEST(ParetoFront, OfEqualCostsTakesTheSmallerErrorAndOfEqualPointsTheFirst) {
  EXPECT_THAT(pareto_front({{1, 5}, {1, 4}, {1, 4}}), ElementsAre(1));
  EXPECT_THAT(pareto_front({{1, 4}, {2, 4}}), ElementsAre(0));
}

TEST(ParetoFront, LeavesOutWhatIsNotFinite) {
  EXPECT_THAT(pareto_front({{NAN, 1}, {1, INFINITY}, {2, NAN}, {3, 2}}), ElementsAre(3));
  EXPECT_THAT(pareto_front({}), IsEmpty());
}

}  // namespace
}  // namespace taut
