#pragma once

#include <memory>

#include "simulator/core/assets/furniture_catalog.hpp"
#include "simulator/core/building/build_scene.hpp"

namespace lapis::simulator {

/// The catalogue as a source of models; every model is read once. An empty function when the catalogue is empty.
FurnitureSource furniture_from(std::shared_ptr<const FurnitureCatalog> catalog);

}  // namespace lapis::simulator
