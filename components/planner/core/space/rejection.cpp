#include "planner/core/space/rejection.hpp"

namespace lapis::planner {

std::string text_of(Rejection rejection) {
  switch (rejection) {
    case Rejection::kNone: return "";
    case Rejection::kNoRoom: return "no room in front of the frontier";
    case Rejection::kUnreachable: return "cannot be reached";
    case Rejection::kHidden: return "hidden from everywhere that can be reached";
    case Rejection::kFailedView: return "looked at in vain";
    case Rejection::kFailed: return "paths to it have failed";
    case Rejection::kUnsure: return "the position would be too unsure there";
    case Rejection::kLeftAlone: return "left alone for now";
    case Rejection::kOutranked: return "others come before it (planner.max_candidates)";
    case Rejection::kFarSpace: return "enough sub-spaces are nearer";
    case Rejection::kBesideStop: return "the tour stops at others near it";
  }
  return "";
}

bool is_geometric(Rejection rejection) { return rejection != Rejection::kNone && rejection <= Rejection::kFailedView; }

}  // namespace lapis::planner
