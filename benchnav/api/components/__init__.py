"""The installed components: their names, their pages, and whether they can be used."""
