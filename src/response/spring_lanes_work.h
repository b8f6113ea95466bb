#pragma once

#include "spring_lanes.h"

namespace mrhi {
namespace {

inline Triple<Wide> everywhere(const double* v) {
  return {constant<Wide>(v[0]), constant<Wide>(v[1]), constant<Wide>(v[2])};
}

inline void write_sum(const Triple<Wide>& v, double* result) {
  result[0] = sum(v.x), result[1] = sum(v.y), result[2] = sum(v.z);
}

// Of all springs on a body with velocity v and angular velocity w, at arms r from its centre:
//
//     u = u_1 - (v + w x r),     spin = n.(w_1 - w)
//     F = sum f,                 T = sum r x f + T_n n
//
// Sums are lane by lane over the fours and then over the lanes, in the same order on every processor:
// floating point's sums hang on their order.
inline void respond(SpringContact<Lanes>* first, SpringContact<Lanes>* last, const double* velocity,
                    bool renew_limits, SpringSum& result) {
  const Triple<Wide> linear = everywhere(velocity), angular = everywhere(velocity + 3);
  const Wide zero = constant<Wide>(0.0);
  Triple<Wide> force{zero, zero, zero}, torque = force;
  Wide push = zero;
  for (; first != last; ++first) {
    SpringContact<Wide>& four = wide(*first);
    const Triple<Wide>& n = four.spring.normal;
    const Triple<Wide> u = four.drive - linear - angular.cross(four.arm);
    four.spring.respond(u, four.drive_spin - n.dot(angular), renew_limits, four.response);
    force = force + four.response.force;
    torque = torque + four.arm.cross(four.response.force) + four.response.torque * n;
    push = push + four.response.push + four.spring.bond;
  }
  write_sum(force, result.force);
  write_sum(torque, result.torque);
  result.push = sum(push);
}

/// Symmetric.
/// S += weight v v'.
struct Slope3 {
  Wide xx, xy, yy, xz, yz, zz;

  void add(const Wide& weight, const Triple<Wide>& v) {
    const Triple<Wide> w = weight * v;
    xx = xx + w.x * v.x, xy = xy + w.x * v.y, yy = yy + w.y * v.y;
    xz = xz + w.x * v.z, yz = yz + w.y * v.z, zz = zz + w.z * v.z;
  }
};

// The point of the body at the arm r moves by J (v, w) = v - [r]x w, so J' = (1; [r]x) and
//
//     J' S J = (  S         .             )      S = s_t 1 + (s_n - s_t) n n' - slip d d' / d'd
//              (  [r]x S    [r]x S [r]x'  )      and the twist's s_T n n' is added at the lower right
//
// s are the slopes of SpringResponse. A row of A [r]x' is r x that row of A, as [r]x' = -[r]x. Only the
// lower triangle is summed, in three blocks: what is symmetric is made once.
inline void slope(const SpringContact<Lanes>* first, const SpringContact<Lanes>* last, SpringSlope& result) {
  const Wide zero = constant<Wide>(0.0), tiny = constant<Wide>(1e-300);
  Wide sums[21];
  for (Wide& entry : sums) entry = zero;
  for (; first != last; ++first) {
    const SpringContact<Wide>& four = wide(*first);
    const SpringResponse<Wide>& response = four.response;
    const Triple<Wide>& r = four.arm;
    const Triple<Wide>& n = four.spring.normal;
    // S of the contact point; [r]x S, of the torque by the velocity; and [r]x S [r]x' with the twist's.
    Slope3 s{response.tangential_slope, zero, response.tangential_slope, zero, zero,
             response.tangential_slope};
    s.add(response.normal_slope - response.tangential_slope, n);
    if (any_above(response.slip, zero))
      s.add(zero - response.slip / greater(response.drawn_squared, tiny), response.drawn);
    const Triple<Wide> x = r.cross({s.xx, s.xy, s.xz}), y = r.cross({s.xy, s.yy, s.yz}),
                       z = r.cross({s.xz, s.yz, s.zz});
    const Triple<Wide> row_x = r.cross({x.x, y.x, z.x}), row_y = r.cross({x.y, y.y, z.y}),
                       row_z = r.cross({x.z, y.z, z.z});
    Slope3 turn{row_x.x, row_x.y, row_y.y, row_x.z, row_y.z, row_z.z};
    turn.add(response.torque_slope, n);
    const Wide entries[21] = {s.xx, s.xy, s.yy, s.xz,    s.yz,    s.zz,  //
                              x.x,  y.x,  z.x,  turn.xx,                 //
                              x.y,  y.y,  z.y,  turn.xy, turn.yy,        //
                              x.z,  y.z,  z.z,  turn.xz, turn.yz, turn.zz};
#pragma GCC unroll 21
    for (int i = 0; i < 21; ++i) sums[i] = sums[i] + entries[i];
  }
  for (int i = 0; i < 21; ++i) result.entry[i] = sum(sums[i]);
}

}  // namespace
}  // namespace mrhi
