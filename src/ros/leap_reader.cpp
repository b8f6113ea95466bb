#include "leap_reader.h"

namespace mrhi {

LeapHumanDecoder::Frame LeapReader::read(const topic_tools::ShapeShifter& message) {
  const LeapHumanDecoder& known = decoder(message);
  bytes_.resize(message.size());
  ros::serialization::OStream stream(bytes_.data(), static_cast<std::uint32_t>(bytes_.size()));
  message.write(stream);
  return known.decode(bytes_.data(), bytes_.size());
}

const LeapHumanDecoder& LeapReader::decoder(const topic_tools::ShapeShifter& message) {
  auto& decoder = decoders_[message.getMD5Sum()];
  if (!decoder) decoder = std::make_unique<const LeapHumanDecoder>(message.getMessageDefinition());
  return *decoder;
}

}  // namespace mrhi
