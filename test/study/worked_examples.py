"""Published data with published results. Rows are participants."""

import numpy as np


def _table(columns, text):
    return np.array(text.split(), float).reshape(-1, columns)


# Field, Discovering Statistics Using SPSS (3rd ed. 2009, chapter 13): seconds until eight people retched on eating
# a stick insect, a kangaroo testicle, a fish eye and a witchetty grub.
BUSHTUCKER = _table(4, '8 7 1 6  9 5 2 5  6 2 3 8  5 3 1 9  8 4 5 8  7 5 6 7  10 2 7 2  12 6 8 1')

# Howell, Statistical Methods for Psychology (7th ed. 2010), table 14.3: hours of headache in five weeks.
MIGRAINE = _table(5, '''21 22 8 6 6  20 19 10 4 4  17 15 5 4 5  25 30 13 12 17  30 27 13 8 6
    19 27 8 7 4  26 16 5 2 5  17 18 8 1 5  26 24 14 8 9''')

# Howell, table 14.4 (King 1986): activity of 24 rats in six intervals; three groups of eight, one after the other.
KING = _table(6, '''
    150 44 71 59 132 74  335 270 156 160 118 230  149 52 91 115 43 154  159 31 127 212 71 224
    159 0 35 75 71 34  292 125 184 246 225 170  297 187 66 96 209 74  170 37 42 66 114 81
    346 175 177 192 239 140  426 329 236 76 102 232  359 238 183 123 183 30  272 60 82 85 101 98
    200 271 263 216 241 227  366 291 263 144 220 180  371 364 270 308 219 267  497 402 294 216 284 255
    282 186 225 134 189 169  317 31 85 120 131 205  362 104 144 114 115 127  338 132 91 77 108 169
    263 94 141 142 120 195  138 38 16 95 39 55  329 62 62 6 93 67  292 139 104 184 193 122''')
KING_GROUPS = ['control'] * 8 + ['same'] * 8 + ['different'] * 8

# Student (1908), The probable error of a mean: hours of sleep gained by ten patients with each of two drugs.
SLEEP_FIRST = [0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0]
SLEEP_SECOND = [1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4]

# Hollander and Wolfe, Nonparametric Statistical Methods (1973), page 29: a depression scale before and after.
DEPRESSION_BEFORE = [1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30]
DEPRESSION_AFTER = [0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06, 3.14, 1.29]
