#!/usr/bin/env python3
"""Every topic and field that config/layouts name is published, and by a field of that name in the topic's message."""
import json
import os
import re
import unittest
import xml.etree.ElementTree

import mr_hand_interaction.msg as messages

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
LAYOUTS = os.path.join(PACKAGE, "config", "layouts")
PUBLISHER = os.path.join(PACKAGE, "src", "ros", "result_publisher.h")
NUMBERS = re.compile(r"(u?int(8|16|32|64)|float(32|64)|bool)$")


def published():
    """Message class by topic, as the node has it."""
    with open(PUBLISHER, encoding="utf-8") as file:
        found = re.findall(r'(?:advertise|add)<mr_hand_interaction::(\w+)>\((?:node,)?\s*"(\w+)"', file.read())
    return {"/" + topic: getattr(messages, name) for name, topic in found}


def type_of(message, path):
    """That of a field; fields of arrays are named as 0/name. None if there is no such field."""
    kind = message._type
    for name in path:
        if name.isdigit():
            if not kind.endswith("]"):
                return None
            kind = re.sub(r"\[\d*\]$", "", kind)
            continue
        fields = fields_of(kind)
        if name not in fields:
            return None
        kind = fields[name]
    return kind


def fields_of(kind):
    if "/" not in kind or kind.endswith("]"):
        return {}
    package, name = kind.split("/")
    module = __import__(package + ".msg", fromlist=[name])
    message = getattr(module, name)
    return dict(zip(message.__slots__, message._slot_types))


def plotjuggler_curves():
    layout = xml.etree.ElementTree.parse(os.path.join(LAYOUTS, "plotjuggler.xml"))
    for curve in layout.iter("curve"):
        _, topic, *fields = re.sub(r"\[(\d+)\]", r"/\1", curve.get("name")).split("/")
        yield "/" + topic, None, fields


def multiplot_curves():
    layout = xml.etree.ElementTree.parse(os.path.join(LAYOUTS, "rqt_multiplot.xml"))
    for axis in layout.iter("y_axis"):
        if axis.find("topic") is not None:
            yield axis.find("topic").text, axis.find("type").text, axis.find("field").text.split("/")


def foxglove():
    with open(os.path.join(LAYOUTS, "foxglove.json"), encoding="utf-8") as file:
        return json.load(file)


def foxglove_curves():
    for name, config in foxglove()["configById"].items():
        for path in config.get("paths", ()):
            _, topic, *fields = re.sub(r"\[(\d+)\]", r".\1", path["value"]).replace("/", ".").split(".")
            yield "/" + topic, None, fields


class LayoutsTest(unittest.TestCase):
    def check(self, curves):
        topics = published()
        for topic, kind, fields in curves:
            self.assertIn(topic, topics)
            if kind is not None:
                self.assertEqual(kind, topics[topic]._type)
            found = type_of(topics[topic], fields)
            self.assertIsNotNone(found, "%s has no field %s" % (topic, "/".join(fields)))
            self.assertRegex(found, NUMBERS)

    def test_plotjuggler(self):
        curves = list(plotjuggler_curves())
        self.assertGreater(len(curves), 15)
        self.check(curves)

    def test_plotjuggler_subscribes_to_what_it_plots(self):
        layout = xml.etree.ElementTree.parse(os.path.join(LAYOUTS, "plotjuggler.xml"))
        wanted = {topic for topic, _, _ in plotjuggler_curves()}
        self.assertEqual({topic.get("name") for topic in layout.iter("topic")}, wanted)

    def test_rqt_multiplot(self):
        curves = list(multiplot_curves())
        self.assertGreater(len(curves), 15)
        self.check(curves)

    def test_foxglove(self):
        curves = list(foxglove_curves())
        self.assertGreater(len(curves), 2)
        self.check(curves)

        def panels(part):
            return [part] if isinstance(part, str) else panels(part["first"]) + panels(part["second"])
        self.assertEqual(sorted(panels(foxglove()["layout"])), sorted(foxglove()["configById"]))

    # As plot_docker.cpp reads it: sizes by number, a place for each child, anything else ends the reading.
    def test_plotjuggler_finds_a_plot_and_a_size_for_each_part_of_a_splitter(self):
        layout = xml.etree.ElementTree.parse(os.path.join(LAYOUTS, "plotjuggler.xml"))
        self.assertEqual([child.tag for child in layout.getroot()].count("tabbed_widget"), 1)
        self.assertEqual([tab.get("containers") for tab in layout.iter("Tab")],
                         [str(len(tab.findall("Container"))) for tab in layout.iter("Tab")])
        splitters = list(layout.iter("DockSplitter"))
        self.assertGreater(len(splitters), 1)
        for splitter in splitters:
            self.assertIn(splitter.get("orientation"), ("-", "|"))
            self.assertEqual(int(splitter.get("count")), len(splitter))
            self.assertEqual(len(splitter.get("sizes").split(";")), len(splitter))
            for area in splitter:
                self.assertEqual((area.tag, len(area.findall("plot"))), ("DockArea", 1))
        for plot in layout.iter("plot"):
            self.assertIn(plot.get("style"), ("Lines", "Dots", "LinesAndDots", "Sticks", "Steps", "StepsInv"))
            self.assertIn(plot.get("mode"), ("TimeSeries", "XYPlot"))

    # As its *Config.cpp read it: a key of another name, or an enumeration's number beyond its last, is not heard of.
    def test_rqt_multiplot_knows_every_key(self):
        known = {"rqt_multiplot": {"table"},
                 "table": {"background_color", "foreground_color", "link_cursor", "link_scale", "track_points", "plots"},
                 "plots": {"row"}, "row": {"column"}, "column": {"axes", "curves", "legend", "plot_rate", "title"},
                 "curves": {"curve"}, "curve": {"axes", "color", "data", "style", "subscriber_queue_size", "title"},
                 "legend": {"visible"}, "axes": {"axes", "x_axis", "y_axis"},
                 "scale": {"type", "absolute_maximum", "absolute_minimum", "relative_maximum", "relative_minimum"},
                 "color": {"custom_color", "type"}, "data": {"circular_buffer_capacity", "time_frame_length", "type"},
                 "style": {"lines_interpolate", "pen_style", "pen_width", "render_antialias", "steps_invert",
                           "sticks_baseline", "sticks_orientation", "type"}}
        axis = {"custom_title", "title_type", "title_visible", "field", "field_type", "scale", "topic", "type"}
        known.update(x_axis=axis, y_axis=axis)
        last = {"scale": 2, "color": 1, "data": 3, "style": 3}

        def plain(element):
            return re.sub(r"_\d+$", "", element.tag)

        for element in xml.etree.ElementTree.parse(os.path.join(LAYOUTS, "rqt_multiplot.xml")).iter():
            for child in element:
                self.assertIn(plain(child), known.get(plain(element), set()), "in %s" % element.tag)
            if plain(element) in last:
                self.assertLessEqual(int(element.find("type").text), last[plain(element)])

    def test_a_field_that_is_not_there_is_noticed(self):
        self.assertIsNone(type_of(messages.ContactArray, ["contacts", "0", "along"]))
        self.assertIsNone(type_of(messages.ContactArray, ["contacts", "normal_force"]))


if __name__ == "__main__":
    unittest.main()
