// What counts the references of boost's shared pointers, for scripts/sanitize threads: libraries that came
// with the system take the first in the program. Theirs are not instrumented, and what a count puts in order
// is no order to ThreadSanitizer.
#include <boost/smart_ptr/detail/sp_counted_base.hpp>

namespace mrhi {

auto released = &boost::detail::sp_counted_base::release;
auto released_weakly = &boost::detail::sp_counted_base::weak_release;

}  // namespace mrhi
