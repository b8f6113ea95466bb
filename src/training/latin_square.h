#pragma once

#include <cstdint>
#include <vector>

namespace mrhi {

/// Order in which a participant (counted from 0) meets n things: a row of a Latin square, shuffled by the
/// seed. Among n participants in a row, the first of them a multiple of n, each thing has each place once;
/// among 2 n (n, if n is even) each also follows each other equally often (Williams 1949).
std::vector<std::size_t> latin_square_order(std::size_t n, std::uint64_t participant, std::uint64_t seed);

}  // namespace mrhi
