#pragma once

#include <span>

namespace lapis::simulator {

/// Groups of articles that can replace each other in a room.
enum class Stock {
  kSofas,
  kArmchairs,
  kLowTables,
  kDiningTables,
  kDiningChairs,
  kMeetingTables,
  kMeetingChairs,
  kDesks,
  kDeskChairs,
  kScreens,
  kDeskThings,
  kSideboards,
  kBookcases,
  kCabinets,
  kWardrobes,
  kDoubleBeds,
  kSingleBeds,
  kHospitalBeds,
  kBedsideTables,
  kSmallLamps,
  kStandingLamps,
  kPlants,
  kTelevisionStands,
  kTelevisions,
  kKitchenUnits,
  kRefrigerators,
  kKitchenThings,
  kBasins,
  kToilets,
  kBaths,
  kWashers,
  kBenches,
  kRugs,
  kCorridorThings,
  kFloorThings,
  kStores,
  kGoods,
  kPallets,
  kRacks,
  kCounters,
  kPanes
};

/// A piece of furniture that generated rooms may get: its model in the catalogue of sweethome3d-furniture (nullptr for
/// parametric furniture), and its size, which is the same with and without the catalogue.
struct Article {
  Stock stock;
  const char* class_name;
  const char* model;
  double width_m, depth_m, height_m;
};

std::span<const Article> articles(Stock stock);

}  // namespace lapis::simulator
