#pragma once

#include <Eigen/Core>

#include "base/random.h"
#include "simulation/builder.h"

namespace vismap {

/// Adds the objects of an office at given places, in random colours and variants. Each method adds
/// one object, or a group of objects, at `place`, which is on the floor or on the surface below the
/// object. See models.h for the fronts and sizes [m].
class OfficeStock {
 public:
  OfficeStock(Furniture* office, Dice dice) : office_(office), dice_(dice) {}

  Dice& dice() { return dice_; }

  /// A desk with a chair and with objects on and under it. The chair faces +y.
  void Workplace(const Place& place);
  /// Two pairs of workplaces, face to face, in a row along x: 3.2 x 3.3 m with the chairs.
  void WorkplacesForFour(const Place& place);
  /// A table of 1.2 x 0.8 m with a chair at both ends.
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
  /// The next three are thin and hang on the wall at y = 0 of the place.
  void Whiteboard(const Place& place);
  void Picture(const Place& place);
  void Clock(const Place& place);
  /// A cabinet of this size. A low one may have books, a printer or a vase on it.
  void Cabinet(const Place& place, const Eigen::Vector3d& size);
  /// A block with the name, class and colour of `object`.
  void Block(SceneObject object, const Place& place, const Eigen::Vector3d& size);
  Furniture& office() { return *office_; }

 private:
  Rgb8 Tint(Rgb8 color);
  void OnDesk(const Place& place);

  Furniture* office_;
  Dice dice_;
};

}  // namespace vismap
