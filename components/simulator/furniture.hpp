#pragma once

#include <memory>

#include "simulator/core/assets/furniture_catalog.hpp"
#include "simulator/core/building/build_scene.hpp"

namespace lapis::simulator {

/// Returns the catalogue as a source of models, which reads each model once; an empty function when the catalogue is
/// empty.
FurnitureSource furniture_from(std::shared_ptr<const FurnitureCatalog> catalog);

}  // namespace lapis::simulator
