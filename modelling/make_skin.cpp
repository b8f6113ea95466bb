#include <cstdio>

#include "skin_model.h"

/// Prints src/rendering/rest_skin.bin: shipped_skins().
int main() {
  for (const std::size_t triangles :
       {mrhi::kDetailedTriangles, mrhi::kHumanTriangles, mrhi::kOutlineTriangles}) {
    const mrhi::SkinModel model =
        mrhi::skinned(mrhi::modelled_skin(triangles), triangles > mrhi::kHumanTriangles);
    mrhi::SkinModel::visit_parts(model, [](const auto& part) {
      const auto count = static_cast<std::uint32_t>(part.size());
      std::fwrite(&count, sizeof count, 1, stdout);
      std::fwrite(part.data(), sizeof part[0], count, stdout);
    });
  }
  return 0;
}
