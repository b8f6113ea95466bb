#include "revision.h"

#include "mr_hand_interaction/training/session_setup.h"

namespace mrhi {

std::string source_revision() {
  return MR_HAND_INTERACTION_REVISION;
}

}  // namespace mrhi
