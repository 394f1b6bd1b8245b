#pragma once

#include <Eigen/Core>

#include "base/random.h"
#include "simulation/builder.h"

namespace vismap {

/// Puts the things of an office where it is told to, in colours and variants that the dice decide.
/// Places are on the floor or on what the thing stands on; see models.h for fronts and sizes.
class OfficeStock {
 public:
  OfficeStock(Furniture* office, Dice dice) : office_(office), dice_(dice) {}

  Dice& dice() { return dice_; }

  /// A desk with its chair and what lies on and under it. Whoever works there looks along y.
  void Workplace(const Place& place);
  /// Two pairs of workplaces face to face along x, 3.2 x 3.3 with the chairs.
  void WorkplacesForFour(const Place& place);
  /// A table, 1.2 x 0.8, with a chair at both ends.
  void TableForTwo(const Place& place);

  void OfficeChair(const Place& place);
  void Chair(const Place& place);
  void Couch(const Place& place);
  void Plant(const Place& place);
  void Lamp(const Place& place);
  void Cup(const Place& place);
  void Bottle(const Place& place);
  void Book(const Place& place);
  void Laptop(const Place& place);
  void Television(const Place& place);
  void Backpack(const Place& place);
  void Bin(const Place& place);
  void Boxes(const Place& place);
  /// Against the wall at y = 0 of the place, thin.
  void Whiteboard(const Place& place);
  void Picture(const Place& place);
  void Clock(const Place& place);
  /// `size` without what may stand on it: books, a printer, a plant, a vase.
  void Cabinet(const Place& place, const Eigen::Vector3d& size);
  /// Any block with a class or without.
  void Block(SceneObject object, const Place& place, const Eigen::Vector3d& size);
  Furniture& office() { return *office_; }

 private:
  Rgb8 Tint(Rgb8 color);
  void OnDesk(const Place& place);

  Furniture* office_;
  Dice dice_;
};

}  // namespace vismap
