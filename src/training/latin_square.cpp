#include "latin_square.h"

#include <numeric>
#include <random>
#include <utility>

namespace mrhi {
namespace {

/// Fisher and Yates, the same with every standard library.
void shuffle(std::vector<std::size_t>& items, std::mt19937_64& random) {
  for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[random() % i]);
}

std::vector<std::size_t> counted(std::size_t n) {
  std::vector<std::size_t> items(n);
  std::iota(items.begin(), items.end(), std::size_t{0});
  return items;
}

/// 0, 1, n - 1, 2, n - 2, ...: neighbours differ by each amount once.
std::size_t zigzag(std::size_t place, std::size_t n) {
  return place % 2 == 1 ? (place + 1) / 2 : (n - place / 2) % n;
}

}  // namespace

std::vector<std::size_t> latin_square_order(std::size_t n, std::uint64_t participant, std::uint64_t seed) {
  if (n == 0) return {};
  std::mt19937_64 random(seed);
  std::vector<std::size_t> things = counted(n), rows = counted(n), mirrored_rows = counted(n);
  shuffle(things, random);
  shuffle(rows, random);
  shuffle(mirrored_rows, random);

  const bool mirrored = n % 2 == 1 && participant / n % 2 == 1;
  const std::size_t row = (mirrored ? mirrored_rows : rows)[participant % n];
  std::vector<std::size_t> order(n);
  for (std::size_t place = 0; place < n; ++place) {
    const std::size_t from = mirrored ? n - 1 - place : place;
    order[place] = things[(zigzag(from, n) + row) % n];
  }
  return order;
}

}  // namespace mrhi
