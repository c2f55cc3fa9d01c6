/* lamp_before_ceiling.h - a room in which a place on the back of a lamp is just where one of its lights is,
 * which rounding sets above it: 0.0000002 apart, the place was as bright as 5 000 000. Found among rooms at
 * random; of 60 others made like it none has such a place. */
#ifndef LAMP_BEFORE_CEILING_H
#define LAMP_BEFORE_CEILING_H

#define LAMP_BEFORE_CEILING                                                                     \
    "LookAt -0.409 1.263 -2.159 0.045 1.336 2.056 0 1 0\n"                                      \
    "Camera \"perspective\" \"float fov\" 50.3\n"                                               \
    "Integrator \"volpath\" \"integer maxdepth\" 8\n"                                           \
    "PixelFilter \"box\"\n"                                                                     \
    "Film \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 24\n"                      \
    "WorldBegin\n"                                                                              \
    "Material \"coateddiffuse\" \"rgb reflectance\" [0.723 0.360 0.587] \"float roughness\" "   \
    "0.122 \"bool remaproughness\" false \"float thickness\" 0.01\n"                            \
    "Shape \"trianglemesh\" \"point3 P\" [-2.45786 0 -2.57057 2.45786 0 -2.57057 2.45786 0 "    \
    "2.57057 -2.45786 0 2.57057] \"integer indices\" [0 1 2 0 2 3]\n"                           \
    "Material \"coateddiffuse\" \"rgb reflectance\" [0.327 0.552 0.619] \"float roughness\" "   \
    "0.128 \"bool remaproughness\" false \"float thickness\" 0.01\n"                            \
    "Shape \"trianglemesh\" \"point3 P\" [-2.45786 2.74945 -2.57057 -2.45786 2.74945 2.57057 "  \
    "2.45786 2.74945 2.57057 2.45786 2.74945 -2.57057 -2.45786 0 2.57057 2.45786 0 "            \
    "2.57057 2.45786 2.74945 2.57057 -2.45786 2.74945 2.57057 -2.45786 0 -2.57057 "             \
    "-2.45786 2.74945 -2.57057 2.45786 2.74945 -2.57057 2.45786 0 -2.57057 2.45786 0 "          \
    "-2.57057 2.45786 2.74945 -2.57057 2.45786 2.74945 2.57057 2.45786 0 2.57057 -2.45786 "     \
    "0 -2.57057 -2.45786 0 2.57057 -2.45786 2.74945 2.57057 -2.45786 2.74945 -2.57057] "        \
    "\"integer indices\" [0 1 2 0 2 3 4 5 6 4 6 7 8 9 10 8 10 11 12 13 14 12 14 15 16 17 18 "   \
    "16 18 19]\n"                                                                               \
    "Material \"coateddiffuse\" \"rgb reflectance\" [0.507 0.705 0.581] \"float roughness\" "   \
    "0.400 \"bool remaproughness\" false \"float thickness\" 0.01\n"                            \
    "Shape \"trianglemesh\" \"point3 P\" [0.00457 0.001 0.01021 0.20551 0.001 0.01431 0.20551 " \
    "0.41682 0.01431 0.00457 0.41682 0.01021 0.00457 0.001 0.01021 0.00457 0.41682 "            \
    "0.01021 -0.00541 0.41682 0.49948 -0.00541 0.001 0.49948 0.20551 0.001 0.01431 "            \
    "0.19554 0.001 0.50357 0.19554 0.41682 0.50357 0.20551 0.41682 0.01431 -0.00541 0.001 "     \
    "0.49948 -0.00541 0.41682 0.49948 0.19554 0.41682 0.50357 0.19554 0.001 0.50357 "           \
    "0.00457 0.41682 0.01021 -0.00541 0.41682 0.49948 0.19554 0.41682 0.50357 0.20551 "         \
    "0.41682 0.01431 -0.05119 0.001 0.71213 0.22921 0.001 0.82684 0.22921 1.11236 0.82684 "     \
    "-0.05119 1.11236 0.71213 -0.05119 0.001 0.71213 -0.05119 1.11236 0.71213 -0.24412 "        \
    "1.11236 1.18372 -0.24412 0.001 1.18372 0.22921 0.001 0.82684 0.03627 0.001 1.29843 "       \
    "0.03627 1.11236 1.29843 0.22921 1.11236 0.82684 -0.24412 0.001 1.18372 -0.24412 "          \
    "1.11236 1.18372 0.03627 1.11236 1.29843 0.03627 0.001 1.29843 -0.05119 1.11236 "           \
    "0.71213 -0.24412 1.11236 1.18372 0.03627 1.11236 1.29843 0.22921 1.11236 0.82684] "        \
    "\"integer indices\" [0 1 2 0 2 3 4 5 6 4 6 7 8 9 10 8 10 11 12 13 14 12 14 15 16 17 18 "   \
    "16 18 19 20 21 22 20 22 23 24 25 26 24 26 27 28 29 30 28 30 31 32 33 34 32 34 35 36 "      \
    "37 38 36 38 39]\n"                                                                         \
    "AttributeBegin\n"                                                                          \
    "Material \"diffuse\"\n"                                                                    \
    "AreaLightSource \"diffuse\" \"rgb L\" [10.707 6.357 4.283]\n"                              \
    "Shape \"trianglemesh\" \"point3 P\" [-0.11889 2.72945 0.02967 1.14824 2.72945 0.02967 "    \
    "1.14824 2.72945 1.2968 -0.11889 2.72945 1.2968] \"integer indices\" [0 1 2 0 2 3]\n"       \
    "AttributeEnd\n"                                                                            \
    "AttributeBegin\n"                                                                          \
    "AreaLightSource \"diffuse\" \"rgb L\" [28.318 28.979 16.677]\n"                            \
    "Material \"diffuse\"\n"                                                                    \
    "Translate -0.3341 2.1332 0.8192\n"                                                         \
    "Shape \"sphere\" \"float radius\" 0.177\n"                                                 \
    "AttributeEnd\n"                                                                            \
    "AttributeBegin\n"                                                                          \
    "AreaLightSource \"diffuse\" \"rgb L\" [35.511 16.375 13.106]\n"                            \
    "Material \"diffuse\"\n"                                                                    \
    "Translate -0.2063 2.0988 1.9144\n"                                                         \
    "Shape \"sphere\" \"float radius\" 0.192\n"                                                 \
    "AttributeEnd\n"

#endif
