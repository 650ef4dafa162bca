"""The map of accuracy: error against time for the numerical settings, on the shipped examples.

decks      changes of the examples' text
scenes     what is run and what is read, one class per scene
knobs      which setting takes which values, where
points     runs: one per scene and settings, resumable
errors     errors, their uncertainty, orders, the front
tables     CSV files of doc/accuracy, text
draw       one picture per scene
__main__   the command
"""
