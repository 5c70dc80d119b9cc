#include "simulator/furniture.hpp"

#include <map>
#include <string>

namespace lapis::simulator {
namespace {

using Sourced = std::variant<SourcedModel, SourceRefusal>;

Sourced read(const FurnitureCatalog& catalog, const std::string& id) {
  const CatalogEntry* entry = catalog.find(id);
  if (entry == nullptr) return SourceRefusal{"the catalogue has no " + id};
  auto loaded = catalog.load(*entry);
  if (const auto* refusal = std::get_if<FurnitureRefusal>(&loaded)) return SourceRefusal{refusal->reason};
  auto& model = std::get<Model>(loaded);
  return SourcedModel{std::move(model.mesh), std::move(model.groups), entry->elevation_m,
                      Credit{entry->name + " (" + entry->id + ")", entry->creator, entry->licence},
                      std::move(model.warnings)};
}

}  // namespace

FurnitureSource furniture_from(std::shared_ptr<const FurnitureCatalog> catalog) {
  if (catalog->empty()) return {};
  auto known = std::make_shared<std::map<std::string, Sourced>>();
  return [catalog = std::move(catalog), known](const FurnitureSpec& item) -> Sourced {
    const auto it = known->find(item.model);
    return it != known->end() ? it->second : known->emplace(item.model, read(*catalog, item.model)).first->second;
  };
}

}  // namespace lapis::simulator
