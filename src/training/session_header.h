#pragma once

#include "mr_hand_interaction/training/session_folder.h"

namespace mrhi {

/// Throws SessionError for what must not be in session.yaml.
void check_header(const SessionHeader& header);
/// The text of session.yaml.
std::string header_text(const SessionHeader& header);
/// Throws SessionError if the file is not that of the same session; `started` and `software` may differ.
void check_same_session(const std::string& file, const SessionHeader& header);

}  // namespace mrhi
