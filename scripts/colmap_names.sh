# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=sh disable=SC2034 # for the scripts that read this in
# What the installed COLMAP calls the options of extracting and matching features: in 3.8 they are SIFT's, in 4.2 those
# of all kinds of features.
case $(colmap feature_extractor -h 2>&1) in
*--FeatureExtraction.use_gpu*) extraction=FeatureExtraction matching=FeatureMatching ;;
*) extraction=SiftExtraction matching=SiftMatching ;;
esac
