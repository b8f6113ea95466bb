#include "../replay/moment_markers.h"

namespace mrhi {

struct MomentMarkers::Kept {};
MomentMarkers::MomentMarkers() = default;
MomentMarkers::~MomentMarkers() = default;
void MomentMarkers::watch(const Simulation&) {}
void MomentMarkers::keep(const Touched&) {}
void MomentMarkers::write(const std::vector<PictureMoment>&, const std::string&) const {}

}  // namespace mrhi
